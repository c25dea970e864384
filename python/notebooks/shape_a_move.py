# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Shape a move
#
# A joint with a mode of 8.12 Hz moves 30 degrees. The command is shaped, so that the tip does not ring.

# %%
import numpy as np
import quell

RATE = 250.0
MODE = (8.12, 0.084)  # natural frequency, Hz, and damping ratio

# %% [markdown]
# The quickest move within the limits of the joint:

# %%
move = quell.plan(0.0, np.deg2rad(30.0), quell.Limits(velocity=2.0, acceleration=8.0, jerk=60.0), rate=RATE)
move

# %% [markdown]
# Which shaper? It depends on how well the mode is known: here 5 % of the frequency, one standard deviation.

# %%
advice = quell.recommend(quell.Mode(*MODE, frequency_std_hz=0.05 * MODE[0]))
advice.best

# %%
shaper = quell.Shaper(advice.best.shaper, MODE, rate=RATE)
shaped = shaper.apply(move.position)
len(shaped) - len(move.position)  # samples that it adds


# %% [markdown]
# What does the joint do? `deformation'' + 2 xi w deformation' + w^2 deformation = -command''`, in numpy:

# %%
def ringing(command, frequency_hz=MODE[0], damping_ratio=MODE[1], steps=8):
    """Deformation of the joint after the command has ended, rad."""
    w, h = 2.0 * np.pi * frequency_hz, 1.0 / RATE / steps
    command = np.append(command, np.full(int(RATE), command[-1]))
    acceleration = np.gradient(np.gradient(command, 1.0 / RATE), 1.0 / RATE)
    x = v = 0.0
    deformation = []
    for a in acceleration:
        for _ in range(steps):
            v += h * (-a - 2.0 * damping_ratio * w * v - w * w * x)
            x += h * v
        deformation.append(x)
    return np.array(deformation[-int(RATE) :])


unshaped = np.abs(ringing(move.position)).max()
left = np.abs(ringing(shaped)).max()
left / unshaped

# %% [markdown]
# EI leaves 5 % at the mode, and no more than that in a wide band around it.

# %%
assert left < 0.06 * unshaped

# %% [markdown]
# The same at the tick of a controller. The shaper can be changed in motion: `filter.retune`.

# %%
filter = quell.AdaptiveFilter(rate=RATE)
filter.install(shaper)
sent = [filter.step(position).position for position in move.position]
assert np.allclose(sent, shaped[: len(sent)], atol=1e-12)

# %%
shaper.plot();

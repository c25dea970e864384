# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Diagnose and patch a simulator
#
# Somebody has a simulator of a flexible joint: a linear spring. The machine's spring hardens. The recordings contradict
# the simulator; `quell.diagnose` says what it lacks, and the simulator gets it.

# %%
import numpy as np
import quell

RATE = 500.0
LIMITS = quell.Limits(velocity=2.5, acceleration=30.0, jerk=600.0)


def simulate(acceleration, frequency_hz, damping_ratio, spring, steps=8):
    """Deformation of the joint, rad: `x'' = -w^2 spring(x) - 2 xi w x' - command''`, by Runge and Kutta."""
    w, h = 2.0 * np.pi * frequency_hz, 1.0 / RATE / steps

    def rate_of(state, a):
        x, v = state
        return np.array([v, -w * w * spring(x) - 2.0 * damping_ratio * w * v - a])

    state, deformation = np.zeros(2), [0.0]
    for now, then in zip(acceleration[:-1], acceleration[1:]):
        for k in range(steps):
            a, b, c = (now + (then - now) * (k + part) / steps for part in (0.0, 0.5, 1.0))
            k1 = rate_of(state, a)
            k2 = rate_of(state + 0.5 * h * k1, b)
            k3 = rate_of(state + 0.5 * h * k2, b)
            k4 = rate_of(state + h * k3, c)
            state = state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        deformation.append(state[0])
    return np.array(deformation)


# %% [markdown]
# The machine: what is hidden in it is `40 x^3`.


# %%
def moves(targets, pause=1.0):
    """Position and acceleration of moves from target to target, with a rest after each."""
    position, acceleration, at = [np.zeros(int(RATE))], [np.zeros(int(RATE))], 0.0
    for target in targets:
        one = quell.plan(at, target, LIMITS, rate=RATE)
        rest = int(pause * RATE)
        position += [one.position[1:], np.full(rest, target)]
        acceleration += [one.acceleration[1:], np.zeros(rest)]
        at = target
    return np.concatenate(position), np.concatenate(acceleration)


def record(targets, name, seed):
    """A recording of the machine, with the noise of its sensor."""
    position, acceleration = moves(targets)
    deformation = simulate(acceleration, 8.0, 0.05, spring=lambda x: x + 40.0 * x**3)
    noise = 2e-5 * np.random.default_rng(seed).standard_normal(len(deformation))
    channels = {"motor_position": position, "deformation": deformation + noise}
    units = {"motor_position": "rad", "deformation": "rad"}
    return quell.Recording.from_arrays(channels, rate=RATE, units=units, name=name)


train = record([0.8, 0.2, 1.1], "monday", seed=1)
test = record([0.5, -0.4], "tuesday", seed=2)

# %% [markdown]
# The model that the simulator believes in:

# %%
model = quell.Model("flexible_joint", natural_frequency_hz=8.2, damping_ratio=0.06)
before = quell.score(model, test)
before

# %%
diagnosis = quell.diagnose(model, train)
diagnosis

# %%
[finding] = diagnosis.findings
assert finding.effect == "cubic_stiffness"
finding["k3"]

# %% [markdown]
# On a recording that it has not seen, the better model leaves the noise:

# %%
after = quell.score(diagnosis.model, test)
assert after.rms_over_noise < 1.1 < before.rms_over_noise
after

# %% [markdown]
# The patch: the simulator with what was found.

# %%
k3 = finding["k3"].value
frequency, damping = diagnosis.model["natural_frequency_hz"], diagnosis.model["damping_ratio"]
_, acceleration = moves([0.5, -0.4])
patched = simulate(acceleration, frequency, damping, spring=lambda x: x + k3 * x**3)
left = np.sqrt(np.mean((test["deformation"].array - patched) ** 2))
assert left < 1.1 * 2e-5
left

# %%
diagnosis.plot()
diagnosis.save_report("diagnosis.html")
diagnosis.model.save("model.toml");

# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Identify a mode from a data frame
#
# An accelerometer at the tip of an arm, in g, sampled at 1 kHz, of which some samples are missing. The arm was tapped
# twice.

# %%
import numpy as np
import pandas as pd
import quell

rng = np.random.default_rng(7)
t = np.arange(0.0, 8.0, 1e-3)
w, xi = 2.0 * np.pi * 11.3, 0.021
acceleration = 0.01 * rng.standard_normal(len(t))
for tap in (1.0, 4.5):
    after = np.clip(t - tap, 0.0, None)
    acceleration += np.where(t > tap, 0.8 * np.exp(-xi * w * after) * np.sin(w * np.sqrt(1.0 - xi**2) * after), 0.0)
data = pd.DataFrame({"time": t, "accel [g]": acceleration})
data.loc[rng.choice(len(t), 20, replace=False), "accel [g]"] = np.nan
data.head()

# %% [markdown]
# The unit is in the column's name. Samples that are missing are left out.

# %%
recording = quell.Recording.from_pandas(data, {"tip_acceleration": "accel [g]"}, name="tapped arm")
recording

# %%
found = quell.identify(recording)
found

# %%
mode = found.modes[0]
assert abs(mode.frequency_hz - 11.3) < 4.0 * mode.frequency_std_hz
assert abs(mode.damping_ratio - 0.021) < 4.0 * mode.damping_std
mode

# %% [markdown]
# The shaper that leaves least for what is known, and the report as one page of HTML:

# %%
found.recommended

# %%
page = found.save_report("identify.html")

# %%
found.to_pandas()

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
# Somebody has a MuJoCo model of a joint: inertia, viscous friction, a position servo. The machine has dry friction that
# falls with the speed, and its commands come late. The recordings contradict the model; `quell.mujoco` says what it
# lacks, and puts it in. It needs `pip install 'quell[mujoco]'`.

# %%
import mujoco
import numpy as np
import quell
import quell.mujoco

RATE, NOISE = 500.0, 1e-5
LIMITS = quell.Limits(velocity=1.5, acceleration=8.0, jerk=80.0)

MJCF = """
<mujoco model="joint">
  <compiler angle="radian"/>
  <option timestep="0.0005" integrator="RK4"/>
  <worldbody>
    <body name="arm">
      <inertial pos="0.3 0 0" mass="6" diaginertia="0.02 0.2 0.2"/>
      <joint name="swing" axis="0 -1 0" armature="0.8" damping="2"/>
    </body>
  </worldbody>
  <actuator><position name="servo" joint="swing" kp="4000" kv="180"/></actuator>
</mujoco>
"""

# %% [markdown]
# The machine: what is hidden in it is Stribeck friction of 6 N.m, 9 N.m at rest, and a delay of 8 ms.


# %%
def moves(targets, pause=0.2):
    """Positions of moves from target to target, with a rest after each."""
    position, at = [np.zeros(100)], 0.0
    for target in targets:
        one = quell.plan(at, target, LIMITS, rate=RATE)
        position += [one.position[1:], np.full(int(pause * RATE), target)]
        at = target
    return np.concatenate(position)


def record(targets, name, seed):
    """A recording of the machine, with the noise of its encoder."""
    model = mujoco.MjModel.from_xml_string(MJCF)
    # Friction that sticks, and does not creep.
    model.dof_frictionloss[0] = 6.0
    model.dof_solref[0], model.dof_solimp[0, :2] = (0.001, 1.0), 0.9999
    data, command = mujoco.MjData(model), moves(targets)
    late, steps = np.concatenate([np.zeros(4), command[:-4]]), int(1.0 / RATE / model.opt.timestep)
    position = []
    for k in range(-200, len(command)):
        if k >= 0:
            position.append(data.qpos[0])
        for _ in range(steps):
            data.ctrl[0] = late[max(k, 0)]
            model.dof_frictionloss[0] = 6.0 * (1.0 + 0.5 * np.exp(-((data.qvel[0] / 0.08) ** 2)))
            mujoco.mj_step(model, data)
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(command))
    channels = {"command_position": command, "motor_position": np.array(position) + noise}
    return quell.Recording.from_arrays(channels, rate=RATE, units=dict.fromkeys(channels, "rad"), name=name)


train = record([0.8, 0.2, 0.5, -0.4, 0.3, -0.6, 0.1], "monday", seed=1)
test = record([0.5, -0.3, 0.9, 0.4], "tuesday", seed=2)

# %% [markdown]
# What MuJoCo makes of tuesday's commands: it is off by hundreds of times the noise.

# %%
before = quell.mujoco.simulate(MJCF, test, "swing")["motor_position"]
before.rms / NOISE

# %% [markdown]
# Gravity and the inertia of the arm are known from the model. What else is there?

# %%
found = quell.mujoco.diagnose(MJCF, train)
found

# %%
joint = found["swing"]
assert {finding.effect for finding in joint.findings} == {"stribeck_friction", "drive_delay"}
joint.drive

# %% [markdown]
# The patch. MJCF holds armature, damping, friction and delay. That friction falls with the speed is a table for a
# callback.

# %%
patched = quell.mujoco.patch(MJCF, found)
patched

# %%
after = quell.mujoco.simulate(patched, test, "swing")["motor_position"]
assert after.rms < 1.1 * NOISE < 0.01 * before.rms
after.rms / NOISE

# %% [markdown]
# Files for those who go on without Quell: `model.xml`, `laws.json`, and `apply.py` with the lines that apply them. And
# what Isaac Lab can hold of it:

# %%
patched.save("patched")
print(quell.mujoco.isaac_lab(MJCF, found, step=0.004))

# %%
joint.drive.plot()
joint.drive.save_report("diagnosis.html");

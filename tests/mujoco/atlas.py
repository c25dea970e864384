"""Loads what the atlas writes for MuJoCo, and says how far it does what the effect does: atlas.py FOLDER.

FOLDER has for each effect NAME.xml, the same machine without it, NAME.plain, and where both laws are the same NAME.csv: what the
effect changes of the sensor's reading, every 2 ms. motion.csv is the motion of the joint "motor", or the command.
"""

import json
import sys
from pathlib import Path

import mujoco
import numpy as np
from scipy.interpolate import CubicSpline

PERIOD = 2e-3
# Moves the motor side as it is told, whatever acts on it.
INERTIA = 1e6
# Until the link hangs in its equilibrium, s: the vibration of 8 Hz and 5 % dies out by 1e-5.
REST = 5.0


def reading(file, motion):
    """First sensor at the stamps of the motion."""
    model = mujoco.MjModel.from_xml_string(file.read_text())
    data = mujoco.MjData(model)
    times = PERIOD * np.arange(len(motion))
    path = CubicSpline(times, motion)
    joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, "motor")
    if joint >= 0:
        model.dof_armature[joint] = INERTIA
    each = round(PERIOD / model.opt.timestep)
    readings = []
    # An axis starts as it stands, whatever acts on it.
    before = round(REST / model.opt.timestep) if joint >= 0 else 0
    for step in range(-before, each * (len(motion) - 1) + 1):
        time = max(step, 0) * model.opt.timestep
        if joint >= 0:
            data.qpos[joint], data.qvel[joint] = path(time), path(time, 1)
            data.qfrc_applied[joint] = INERTIA * path(time, 2)
        else:
            # A controller reads its reference from tick to tick.
            data.ctrl[0] = motion[max(step, 0) // each]
        mujoco.mj_step(model, data)
        if step >= 0 and step % each == 0:
            readings.append(data.sensordata[0])
    return np.array(readings)


def main(folder):
    motion = np.loadtxt(folder / "motion.csv")
    errors, plain = {}, {}
    for file in sorted(folder.glob("*.xml")):
        mujoco.MjModel.from_xml_string(file.read_text())
        told = file.with_suffix(".csv")
        if not told.exists():
            continue
        base = file.with_suffix(".plain")
        key = base.read_text()
        if key not in plain:
            plain[key] = reading(base, motion)
        change = np.loadtxt(told)
        error = reading(file, motion) - plain[key] - change
        errors[file.stem] = float(np.linalg.norm(error) / np.linalg.norm(change))
    print(json.dumps(errors))


main(Path(sys.argv[1]))

"""Torques and inertias of random states of a URDF, by MuJoCo and by Pinocchio, as JSON lines.

peers.py ROBOT.urdf COUNT SEED: each line has q, v, a in the order of the joints in the file, and for each peer the torques of
that motion and the diagonal of the mass matrix.
"""
import json
import re
import sys
import tempfile
from pathlib import Path

import mujoco
import numpy as np
import pinocchio


def main(file, count, seed):
    text = Path(file).read_text()
    names = re.findall(r'<joint name="(\w+)" type="(?:revolute|continuous|prismatic)"', text)
    arm = pinocchio.buildModelFromUrdf(file)
    data = arm.createData()
    # MuJoCo drops masses of links that it fuses into others, and bodies without inertia, unless it is told.
    extension = '<mujoco><compiler fusestatic="false" discardvisual="false" balanceinertia="false"/></mujoco>'
    with tempfile.TemporaryDirectory() as folder:
        own = Path(folder) / "arm.urdf"
        own.write_text(text.replace("</robot>", extension + "</robot>"))
        engine = mujoco.MjModel.from_xml_path(str(own))
    engine.opt.gravity[:] = [0.0, 0.0, -9.81]
    engine.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    engine.dof_damping[:] = 0.0
    engine.dof_frictionloss[:] = 0.0
    state = mujoco.MjData(engine)
    in_pinocchio = [arm.joints[arm.getJointId(name)].idx_v for name in names]
    in_mujoco = [engine.joint(name).dofadr[0] for name in names]
    random = np.random.default_rng(seed)
    for _ in range(count):
        q, v, a = random.uniform(-2.0, 2.0, (3, len(names)))
        line = {"q": q.tolist(), "v": v.tolist(), "a": a.tolist()}
        line["pinocchio"] = by_pinocchio(arm, data, in_pinocchio, q, v, a)
        line["mujoco"] = by_mujoco(engine, state, in_mujoco, q, v, a)
        print(json.dumps(line))


def by_pinocchio(arm, data, order, *motion):
    own = []
    for values in motion:
        series = np.zeros(arm.nv)
        series[order] = values
        own.append(series)
    torques = pinocchio.rnea(arm, data, *own)
    mass = pinocchio.crba(arm, data, own[0])
    return {"torques": torques[order].tolist(), "inertias": np.diag(mass)[order].tolist()}


def by_mujoco(engine, state, order, q, v, a):
    state.qpos[order], state.qvel[order], state.qacc[order] = q, v, a
    mujoco.mj_inverse(engine, state)
    torques = state.qfrc_inverse[order]
    mass = np.zeros((engine.nv, engine.nv))
    mujoco.mj_fullM(engine, state, mass)
    return {"torques": torques.tolist(), "inertias": (np.diag(mass) - engine.dof_armature)[order].tolist()}


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))

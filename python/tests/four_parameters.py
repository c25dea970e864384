"""The usual fit of a simulator: friction, damping, armature and stiffness of a joint, by rollouts in MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import quell.mujoco
import scipy.optimize

from quell import Recording

NAMES = ("frictionloss", "damping", "armature", "stiffness")


def with_parameters(mjcf: str, joint: str, values: np.ndarray) -> mujoco.MjModel:
    """The model with the four of a joint; a joint with friction sticks as it does in a patched model."""
    spec = mujoco.MjSpec.from_string(mjcf)
    element = spec.joint(joint)
    friction, damping, armature, stiffness = (float(value) for value in values)
    element.frictionloss, element.armature = friction, armature
    element.damping, element.stiffness = [damping, 0.0, 0.0], [stiffness, 0.0, 0.0]
    element.solref_friction, element.solimp_friction = [2.0 * spec.option.timestep, 1.0], [0.9999, 0.9999, 0.001, 0.5, 2.0]
    return spec.compile()


def errors(model: object, log: dict[str, Recording], joint: str) -> np.ndarray:
    """Recorded minus simulated, of motor and link."""
    told = quell.mujoco.simulate(model, log, joint).values()
    return np.concatenate([one.recorded - one.predicted for one in told])


def fit(mjcf: str, log: dict[str, Recording], joint: str) -> mujoco.MjModel:
    """The model with the four that fit best, from where the description begins."""
    given = mujoco.MjModel.from_xml_string(mjcf)
    dof = int(given.joint(joint).dofadr[0])
    armature, damping = float(given.dof_armature[dof]), float(given.dof_damping[dof])
    scale = np.array([damping, damping, armature, 10.0 * damping])
    start = np.array([0.1 * damping, damping, armature, 0.0]) / scale

    def residual(x: np.ndarray) -> np.ndarray:
        return 1e5 * errors(with_parameters(mjcf, joint, x * scale), log, joint)

    bounds = ([0.0, 0.0, 1e-3, 0.0], [np.inf] * 4)
    found = scipy.optimize.least_squares(residual, np.maximum(start, 1e-6), bounds=bounds, max_nfev=12, diff_step=1e-3)
    return with_parameters(mjcf, joint, found.x * scale)

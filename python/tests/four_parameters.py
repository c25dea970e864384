"""The usual fit of a simulator: friction, damping, armature and stiffness of a joint, by rollouts in MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import quell.mujoco
import scipy.optimize

from quell import Recording, _quell

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
    return np.concatenate([one.recorded - one.predicted - one.offset for one in told])


def first_look(mjcf: str, log: dict[str, Recording], joint: str) -> np.ndarray:
    """The four by linear regression of the measured torque, as they are identified without a simulator."""
    known = quell.mujoco.known(mjcf, log)[joint]
    time = known["motor_position"].stamps
    q, v, a = _quell.course(time, known["motor_position"].array)
    left = known["torque"].array + known["known_force"].array - known["inertia"].array * a
    moves = np.abs(v) > 0.05 * np.abs(v).max()
    columns = np.stack([np.sign(v), v, a, q, np.ones_like(q)], axis=1)
    return np.maximum(np.linalg.lstsq(columns[moves], left[moves], rcond=None)[0][:4], 0.0)


def fit(mjcf: str, log: dict[str, Recording], joint: str) -> mujoco.MjModel:
    """The model with the four that fit best: from a first look and from the description, whichever ends better."""
    given = mujoco.MjModel.from_xml_string(mjcf)
    dof = int(given.joint(joint).dofadr[0])
    armature, damping = float(given.dof_armature[dof]), float(given.dof_damping[dof])
    scale = np.array([damping, damping, armature, 10.0 * damping])

    def residual(x: np.ndarray) -> np.ndarray:
        return 1e5 * errors(with_parameters(mjcf, joint, x * scale), log, joint)

    bounds = ([0.0, 0.0, 1e-3, 0.0], [np.inf] * 4)
    look = first_look(mjcf, log, joint)
    starts = [np.array([look[0], damping, armature, 0.0]), np.array([0.0, damping, armature, 0.0])]
    starts = [np.maximum(start / scale, 2e-3) for start in starts]
    start = min(starts, key=lambda one: float(np.square(residual(one)).sum()))
    found = scipy.optimize.least_squares(residual, start, bounds=bounds, x_scale="jac", max_nfev=15, diff_step=1e-2)
    return with_parameters(mjcf, joint, found.x * scale)

"""A recorded motion of all joints, and what MuJoCo's rigid bodies say along it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from .. import _quell
from ..errors import RecordingError
from ..recording import Recording
from ._engine import mujoco
from ._joints import Joint, joint_of

__all__ = ["Course", "Log", "Motion", "RigidBody", "log_of"]

Array = NDArray[np.float64]
Log = Union[Mapping[str, Recording], Recording, str, Path]


def log_of(log: Log, joints: Mapping[str, Joint]) -> dict[str, Recording]:
    """The recordings of the joints by name."""
    if isinstance(log, (str, Path)):
        log = Recording.joints(log) or Recording.load(log)
    if isinstance(log, Recording):
        if len(joints) != 1:
            text = f'"{log.name}" names no joint, and the model has {len(joints)}: give a recording by joint'
            raise RecordingError(text)
        log = {name: log for name in joints}
    for name in log:
        joint_of(joints, name)
    return dict(log)


@dataclass(frozen=True)
class Course:
    """Position, velocity and acceleration of a joint at its stamps, shape (n,) each."""

    time: Array
    position: Array
    velocity: Array
    acceleration: Array

    @classmethod
    def of(cls, recording: Recording, joint: Joint, role: str) -> Course:
        """The smoothed motion of a position channel."""
        channel = recording[role]
        if channel.unit != joint.position_unit:
            text = f'joint "{joint.name}" of "{recording.name}": {role} is in {channel.unit}, not {joint.position_unit}'
            raise RecordingError(text)
        time = np.ascontiguousarray(channel.stamps)
        return cls(time, *_quell.course(time, np.ascontiguousarray(channel.array)))

    def at(self, time: Array) -> tuple[Array, Array, Array]:
        """The state at other instants: cubic between stamps, at rest before the first and after the last."""
        last = len(self.time) - 1
        k = np.clip(np.searchsorted(self.time, time, side="right") - 1, 0, max(last - 1, 0))
        if last == 0:
            return np.full(len(time), self.position[0]), np.zeros(len(time)), np.zeros(len(time))
        h = self.time[k + 1] - self.time[k]
        s = np.clip((time - self.time[k]) / h, 0.0, 1.0)
        moves = (time >= self.time[0]) & (time <= self.time[last])
        position = _cubic(s, h, self.position[k], self.velocity[k], self.position[k + 1], self.velocity[k + 1])
        velocity = _cubic(
            s, h, self.velocity[k], self.acceleration[k], self.velocity[k + 1], self.acceleration[k + 1]
        )
        acceleration = self.acceleration[k] + s * (self.acceleration[k + 1] - self.acceleration[k])
        return position, np.where(moves, velocity, 0.0), np.where(moves, acceleration, 0.0)


def _cubic(s: Array, h: Array, x: Array, v: Array, y: Array, w: Array) -> Array:
    a, b, rise = h * v, h * w, y - x
    return x + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)))


# Where the body behind a joint is seen, in the order of preference.
SEEN = ("link_position", "motor_position", "command_position")


class Motion:
    """The motion of every joint of a model; one that was not recorded stands at its reference."""

    def __init__(self, joints: Mapping[str, Joint], log: Mapping[str, Recording]) -> None:
        self.joints = joints
        self.links: dict[str, Course] = {}
        self.motors: dict[str, Course] = {}
        for name, recording in log.items():
            joint = joint_of(joints, name)
            roles = [role for role in SEEN if role in recording]
            if not roles:
                raise RecordingError(f'joint "{name}" of "{recording.name}" has no position')
            self.links[name] = Course.of(recording, joint, roles[0])
            motor = "motor_position" in recording and roles[0] != "motor_position"
            self.motors[name] = Course.of(recording, joint, "motor_position") if motor else self.links[name]


class RigidBody:
    """
    MuJoCo's rigid bodies, without what a joint has of its own: friction, damping, armature and limits.

    Springs of the model stay: they are known.
    """

    def __init__(self, model: Any, motion: Motion) -> None:
        self.model = mujoco.MjModel.__copy__(model)
        disabled = mujoco.mjtDisableBit
        for bit in (disabled.mjDSBL_CONSTRAINT, disabled.mjDSBL_DAMPER, disabled.mjDSBL_ACTUATION):
            self.model.opt.disableflags |= int(bit)
        self.model.dof_armature[[joint.dof for joint in motion.joints.values()]] = 0.0
        self.data = mujoco.MjData(self.model)
        self.motion = motion

    def along(self, joint: Joint, time: Array, *, own: bool) -> tuple[Array, Array]:
        """
        The torque that the motion takes at a joint, and the inertia seen there.

        Parameters
        ----------
        joint : Joint
            The joint.
        time : ndarray
            Instants, s, shape (n,).
        own : bool
            Whether the joint's own acceleration counts.

        Returns
        -------
        torque, inertia : ndarray
            `tau_j(q, q', q'')` in N.m (N), and `M_jj(q)` in kg.m^2 (kg), shape (n,) each. The armature of the joints is
            in neither.
        """
        states = {name: course.at(time) for name, course in self.motion.links.items()}
        torque, inertia = np.empty(len(time)), np.empty(len(time))
        data, unit, column = self.data, np.zeros(self.model.nv), np.empty(self.model.nv)
        unit[joint.dof] = 1.0
        mujoco.mj_resetData(self.model, data)
        for k in range(len(time)):
            for name, (position, velocity, acceleration) in states.items():
                other = self.motion.joints[name]
                data.qpos[other.qpos] = position[k]
                data.qvel[other.dof] = velocity[k]
                data.qacc[other.dof] = acceleration[k] if own or name != joint.name else 0.0
            mujoco.mj_inverse(self.model, data)
            torque[k] = data.qfrc_inverse[joint.dof]
            mujoco.mj_mulM(self.model, data, column, unit)
            inertia[k] = column[joint.dof]
        return torque, inertia

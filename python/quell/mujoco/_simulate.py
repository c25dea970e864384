"""A model in MuJoCo with the input that was recorded."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import NDArray

from .._result import Result
from ..errors import SimulationError
from ..recording import Recording
from ._engine import model_of, mujoco
from ._joints import Actuator, Joint, actuator_of, joint_of, joints_of
from ._motion import Log, Motion, log_of
from ._patched import Patched

__all__ = ["Simulated", "simulate"]

Array = NDArray[np.float64]
Input = Literal["command", "motor"]
# Inertia, over the greatest of the model, of a joint that follows its recorded motion whatever pulls at it: what pulls, a
# servo without a command among it, is a thousand times what moves it.
HEAVY = 1e6


@dataclass(frozen=True, eq=False)
class Simulated(Result):
    """
    What MuJoCo makes of a recorded input.

    Parameters
    ----------
    document : dict
        The errors, as `to_dict` gives them.
    joint : str
        The joint.
    role : str
        The channel that is predicted: `motor_position` or `link_position`.
    time : ndarray
        The recording's stamps, s, shape (n,).
    recorded : ndarray
        What was recorded, rad (m).
    predicted : ndarray
        What MuJoCo says, rad (m).
    offset : float
        The mean of the difference, rad (m): where an encoder has its zero, no model says.
    rms : float
        Root mean square of the difference without `offset`, rad (m).
    """

    joint: str
    role: str
    time: Array
    recorded: Array
    predicted: Array
    offset: float
    rms: float


def simulate(
    model: Union[Patched, Any],
    log: Log,
    joint: str,
    *,
    input: Input = "command",
) -> dict[str, Simulated]:
    """
    Simulate a joint in MuJoCo with the input that was recorded.

    All other joints follow their recorded motion. The joint's actuator gets what was recorded at each instant:
    `command_position`, held from sample to sample, where it is a position servo, else `torque` (`force`), linear between
    samples.

    Parameters
    ----------
    model : Patched, path, str, mujoco.MjSpec or mujoco.MjModel
        The model. The laws of a patched one act through its callback, which is taken out again.
    log : mapping of str to Recording, Recording or path
        Recordings by joint, as `known` takes them.
    joint : str
        The joint.
    input : {"command", "motor"}, default "command"
        What drives it: its actuator, or `motor_position` as it was recorded, so that the link behind it moves alone.

    Returns
    -------
    dict of str to Simulated
        By role: `motor_position` and `link_position` as far as they were recorded; the latter alone behind a motor that
        follows. The link of a joint that does not bend stands where its motor does.

    Raises
    ------
    SimulationError
        Where the input was not recorded, the model has no actuator for it, or the simulation diverges.
    ModelError
        Where MuJoCo cannot read the model, or it has no such joint.
    """
    patched = model if isinstance(model, Patched) else None
    compiled = mujoco.MjModel.__copy__(patched.model() if patched else model_of(model))
    joints = joints_of(compiled)
    bends = patched.bends if patched else {}
    recordings = log_of(log, {name: own for name, own in joints.items() if name not in bends.values()})
    if joint not in recordings:
        joint_of(joints, joint)
        raise SimulationError(f'joint "{joint}" is not in the recording')
    run = _Run(compiled, joints, bends, recordings, joint, input)
    before = mujoco.get_mjcb_passive()
    if patched and patched.laws:
        mujoco.set_mjcb_passive(patched.passive(compiled))
    try:
        return run.result()
    finally:
        mujoco.set_mjcb_passive(before)


class _Run:
    """One joint that is simulated among others that follow their recorded motion."""

    def __init__(
        self,
        model: Any,
        joints: dict[str, Joint],
        bends: dict[str, str],
        log: dict[str, Recording],
        joint: str,
        input: Input,
    ) -> None:
        self.model, self.joints, self.bends, self.log = model, joints, bends, log
        self.own, self.recording, self.input = joints[joint], log[joint], input
        if input == "motor" and joint not in bends:
            raise SimulationError(f'joint "{joint}" of the model is rigid: its link does not move alone')
        self.motion = Motion(joints, log)
        self.actuator = actuator_of(model, self.own)
        wanted = ("link_position",) if input == "motor" else ("motor_position", "link_position")
        self.roles = [role for role in wanted if role in self.recording]
        if not self.roles or "motor_position" not in self.recording:
            raise SimulationError(f'joint "{joint}": {" and ".join({*wanted, "motor_position"})} was not recorded')
        self.followers = self._followers()
        self.data = mujoco.MjData(model)

    def _followers(self) -> list[tuple[Joint, bool]]:
        """The joints that follow, each with whether it was recorded; else it stands, as what bends elsewhere does."""
        bend = self.bends.get(self.own.name)
        moving = {bend} if self.input == "motor" else {self.own.name, bend}
        followers = [(own, name in self.log) for name, own in self.joints.items() if name not in moving]
        heavy = HEAVY * max(float(np.max(self.model.dof_M0)), 1.0)
        for own, _ in followers:
            self.model.dof_armature[own.dof] = heavy
        # The solver of constraints ends where its cost falls by less than this, and heavy joints make all costs great: it
        # would end before it sees friction, or the soft end of a play.
        self.model.opt.tolerance = 0.0
        return followers

    def result(self) -> dict[str, Simulated]:
        stamps = self.recording[self.roles[0]].stamps
        step = float(self.model.opt.timestep)
        count = math.ceil((stamps[-1] - stamps[0]) / step) + 1
        time = stamps[0] + step * np.arange(count + 1, dtype=np.float64)
        courses = self._courses(time)
        control = self._control(time)
        self._start(courses, control)
        bend = self.joints.get(self.bends.get(self.own.name, ""), None)
        both = [self.own] if bend is None else [self.own, bend]
        where, speed = np.zeros((count, len(both))), np.zeros((count, len(both)))
        qpos, dofs, data = [one.qpos for one in both], [one.dof for one in both], self.data
        for k in range(count):
            self._follow(courses, k)
            if control is not None and self.actuator is not None:
                data.ctrl[self.actuator.index] = control[k]
            where[k], speed[k] = data.qpos[qpos], data.qvel[dofs]
            mujoco.mj_step(self.model, data)
        if data.warning[int(mujoco.mjtWarning.mjWARN_BADQACC)].number or not np.isfinite(where).all():
            raise SimulationError(f'joint "{self.own.name}": the simulation diverges; a smaller timestep may help')
        sides = {"motor_position": slice(0, 1), "link_position": slice(0, 2)}
        sums = {role: (where[:, sides[role]].sum(axis=1), speed[:, sides[role]].sum(axis=1)) for role in self.roles}
        return {role: self._told(role, time[:count], *sums[role]) for role in self.roles}

    def _courses(self, time: Array) -> list[tuple[Joint, Array, Array, Array]]:
        told: list[tuple[Joint, Array, Array, Array]] = []
        # A force is held within each step: it is that of its middle.
        middle = time + 0.5 * float(self.model.opt.timestep)
        for own, recorded in self.followers:
            if recorded:
                sides = self.motion.motors if own.name == self.own.name else self.motion.links
                position, velocity, _ = sides[own.name].at(time)
                told.append((own, position, velocity, sides[own.name].at(middle)[2]))
            else:
                still = np.full(len(time), float(self.model.qpos0[own.qpos]))
                told.append((own, still, np.zeros(len(time)), np.zeros(len(time))))
        return told

    def _control(self, time: Array) -> Array | None:
        if self.input == "motor":
            return None
        actuator, role = self.actuator, _role(self.actuator, self.recording)
        if actuator is None or role is None:
            wanted = "an actuator" if actuator is None else "command_position or torque"
            raise SimulationError(f'joint "{self.own.name}" has no {wanted}: nothing drives it')
        channel = self.recording[role]
        if role != "command_position":
            return actuator.gear * np.interp(time, channel.stamps, channel.array)
        # A step that begins within rounding of a stamp has its sample.
        near = 1e-6 * float(self.model.opt.timestep)
        last = np.searchsorted(channel.stamps, time + near, side="right") - 1
        return actuator.gear * channel.array[np.clip(last, 0, None)]

    def _follow(self, courses: list[tuple[Joint, Array, Array, Array]], k: int) -> None:
        for own, position, velocity, acceleration in courses:
            self.data.qpos[own.qpos], self.data.qvel[own.dof] = position[k], velocity[k]
            self.data.qfrc_applied[own.dof] = self.model.dof_armature[own.dof] * acceleration[k]

    def _start(self, courses: list[tuple[Joint, Array, Array, Array]], control: Array | None) -> None:
        """At the recorded start, the actuator's memory full of the first input, what bends in equilibrium."""
        data, motor = self.data, self.motion.motors[self.own.name]
        mujoco.mj_resetData(self.model, data)
        data.qpos[self.own.qpos], data.qvel[self.own.dof] = motor.position[0], motor.velocity[0]
        bend = self.joints.get(self.bends.get(self.own.name, ""))
        if bend is not None and self.own.name in self.motion.links:
            link = self.motion.links[self.own.name]
            data.qpos[bend.qpos] = link.position[0] - motor.position[0]
            data.qvel[bend.dof] = link.velocity[0] - motor.velocity[0]
        self._follow(courses, 0)
        if control is None or self.actuator is None:
            return
        index, first = self.actuator.index, control[0]
        if (address := int(self.model.actuator_actadr[index])) >= 0:
            data.act[address] = first
        samples = int(self.model.actuator_history[index, 0])
        if samples > 0:
            step = float(self.model.opt.timestep)
            times = step * np.arange(-samples, 0.0)
            mujoco.mj_initCtrlHistory(self.model, data, index, times, np.full(samples, first))

    def _told(self, role: str, time: Array, where: Array, speed: Array) -> Simulated:
        stamps, recorded = self.recording[role].stamps, self.recording[role].array
        k = np.clip(np.searchsorted(time, stamps, side="right") - 1, 0, len(time) - 2)
        h = time[k + 1] - time[k]
        s = (stamps - time[k]) / h
        # Cubic between steps: the stamps need not be on them.
        a, b, rise = h * speed[k], h * speed[k + 1], where[k + 1] - where[k]
        predicted = where[k] + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)))
        offset, rms = float(np.mean(recorded - predicted)), float(np.std(recorded - predicted))
        document = {"joint": self.own.name, "role": role, "offset": offset, "rms": rms}
        return Simulated(document, self.own.name, role, stamps, recorded, predicted, offset, rms)


def _role(actuator: Actuator | None, recording: Recording) -> str | None:
    roles = ("command_position",) if actuator is not None and actuator.is_servo else ("torque", "force")
    return next((role for role in roles if role in recording), None)

"""What each joint of a model lacks."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Union

from .._progress import Progress, shown
from .._result import Result, bold, in_lines, paragraph, table
from ..diagnosis import Diagnosis, diagnose as diagnose_one
from ..findings import Finding
from ..recording import Recording
from ._believed import Side, drive_side, known_channels, spring, transmission_side
from ._engine import model_of
from ._joints import Joint, actuator_of, joint_of, joints_of
from ._motion import Log, Motion, RigidBody, log_of

__all__ = ["JointDiagnosis", "RobotDiagnosis", "diagnose", "known"]


@dataclass(frozen=True, eq=False)
class JointDiagnosis(Result):
    """
    What a joint lacks.

    Parameters
    ----------
    document : dict
        All of it, as `to_dict` gives it.
    joint : str
        Its name in the MJCF.
    drive : Diagnosis or None
        The motor side: rotor, friction, delay, lag. None where its input was not recorded.
    transmission : Diagnosis or None
        The spring between motor and link. None where the joint is rigid, or its link was not seen.
    inertia : float
        The mean of the inertia of the links as the joint sees it, kg.m^2 (kg where it slides).
    """

    joint: str
    drive: Diagnosis | None
    transmission: Diagnosis | None
    inertia: float

    def __repr__(self) -> str:
        return in_lines(f"JointDiagnosis({self.joint!r}, inertia {self.inertia:.4g})", self._lines(), "drive and transmission have more")

    def _lines(self) -> list[str]:
        return [line for side in self._sides() for line in (f"{side.verdict}: {side.summary}", *map(str, side.findings))]

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is missing on both sides."""
        return tuple(one for side in self._sides() for one in side.findings)

    @property
    def armature(self) -> float | None:
        """The inertia that turns with the motor, kg.m^2 (kg)."""
        return self.drive.model["mass"] if self.drive else None

    @property
    def damping(self) -> float | None:
        """The viscous friction of the motor side that the model has, refitted, N.m.s/rad (N.s/m)."""
        return self.drive.model["viscous"] if self.drive else None

    @property
    def stiffness(self) -> float | None:
        """The stiffness of the transmission, N.m/rad (N/m); none of a joint that is rigid."""
        return self._spring()[0] if self.transmission else None

    @property
    def spring_damping(self) -> float | None:
        """The damping across the transmission, N.m.s/rad (N.s/m); none of a joint that is rigid."""
        return self._spring()[1] if self.transmission else None

    def _spring(self) -> tuple[float, float]:
        model = self.transmission.model if self.transmission else None
        if model is None:
            return 0.0, 0.0
        w, inertia = 2.0 * math.pi * model["natural_frequency_hz"], model["link_inertia"]
        return inertia * w * w, 2.0 * model["damping_ratio"] * w * inertia

    def _sides(self) -> list[Diagnosis]:
        return [side for side in (self.drive, self.transmission) if side is not None]

    @property
    def summary(self) -> str:
        """One sentence a side."""
        elastic = f"elastic: {self.stiffness:.4g} N.m/rad. " if self.stiffness else ""
        return elastic + " ".join(side.summary for side in self._sides())


@dataclass(frozen=True, eq=False)
class RobotDiagnosis(Result):
    """
    What the joints of a robot lack.

    Parameters
    ----------
    document : dict
        All of it, as `to_dict` gives it.
    joints : dict of str to JointDiagnosis
        By the joint's name.
    set_aside : dict of str to str
        Joints that were recorded and could not be diagnosed, with why.
    """

    joints: dict[str, JointDiagnosis]
    set_aside: dict[str, str] = field(default_factory=lambda: dict[str, str]())

    def __repr__(self) -> str:
        joints = [f"{name}: {one.summary}" for name, one in self.joints.items()]
        aside = [f"{name} was set aside: {why}" for name, why in self.set_aside.items()]
        return in_lines(f"RobotDiagnosis of {len(self.joints)} joints", [*joints, *aside], "each joint, as diagnosis[name], has more")

    def __getitem__(self, joint: str) -> JointDiagnosis:
        return self.joints[joint]

    def _repr_html_(self) -> str:
        rows: list[list[object]] = []
        for name, own in self.joints.items():
            for side in own._sides():
                named = [f"{one.effect} ({one.place})" for one in side.findings]
                noise = (side.fit.before.held_out_over_noise, side.fit.after.held_out_over_noise)
                rows.append([name, side.verdict, ", ".join(named), own.armature, own.stiffness, *noise])
        heads = ["joint", "verdict", "missing", "armature", "stiffness", "before / noise", "after / noise"]
        aside = "".join(paragraph(f"{name}: {why}") for name, why in self.set_aside.items())
        return bold("Joints") + table(heads, rows) + aside


def known(mjcf: Any, log: Log) -> dict[str, Recording]:
    """
    Add to each joint's recording what MuJoCo's rigid bodies say along the motion of all joints.

    `known_force = M_jj q_j'' - tau_j(q, q', q'')` has gravity, Coriolis and centrifugal forces and the accelerations of
    the other joints (`mj_inverse`); `inertia = M_jj(q)` is what the joint sees of the links. Friction, damping and
    armature of the joints are in neither. Velocities and accelerations come from the positions by a smoother whose
    bandwidth is the likeliest.

    Parameters
    ----------
    mjcf : path, str, mujoco.MjSpec or mujoco.MjModel
        The model.
    log : mapping of str to Recording, Recording or path
        Recordings by joint; one recording where the model has one joint; or a manifest or an MCAP file that names the
        joints.

    Returns
    -------
    dict of str to Recording
        By joint: its channels, `known_force` and `inertia`.

    Raises
    ------
    ModelError
        Where MuJoCo cannot read the model, or it has no such joint.
    RecordingError
        Where a joint has no position.
    """
    model = model_of(mjcf)
    joints = joints_of(model)
    recordings = log_of(log, joints)
    motion = Motion(joints, recordings)
    bodies = RigidBody(model, motion)
    told: dict[str, Recording] = {}
    for name, recording in recordings.items():
        told[name] = _with_known(recording, joints[name], bodies)
    return told


def _with_known(recording: Recording, joint: Joint, bodies: RigidBody) -> Recording:
    time = bodies.motion.links[joint.name].time
    force, inertia = bodies.along(joint, time, own=False)
    channels = {channel.role: channel for channel in recording.channels}
    extra = known_channels(joint, time, -force, inertia)
    return Recording.from_arrays({**channels, **extra}, name=recording.name, payload=recording.payload)


def diagnose(
    mjcf: Any,
    logs: Union[Log, Sequence[Log]],
    *,
    joints: Sequence[str] | None = None,
    seed: int = 1,
    time_limit: float | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> RobotDiagnosis:
    """
    Say what each joint of a MuJoCo model lacks, from recordings of the robot.

    A joint with `motor_position` and an input is a rigid axis behind its drive. The input is `command_position` where
    the model's actuator is a position servo, else `torque` (`force` where it slides). Where `link_position` was recorded
    besides, and the deformation follows the torque of the link, the spring between both is a side of its own.

    Parameters
    ----------
    mjcf : path, str, mujoco.MjSpec or mujoco.MjModel
        The model that is believed in.
    logs : mapping of str to Recording, Recording, path, or sequence of them
        Recordings by joint, as `known` takes them; several are several runs of one robot.
    joints : sequence of str, optional
        The joints to diagnose; all that were recorded by default.
    seed : int, default 1
        Seed of the confidence intervals' bootstrap.
    time_limit : float, optional
        Ends the search for further effects after so many seconds: each side has an equal part of what is left.
    threads : int, optional
        Threads to work with; one a core by default.
    progress : bool or callable, optional
        As in `quell.diagnose`, over all sides; what is being done begins with the joint and its side.

    Returns
    -------
    RobotDiagnosis
        A `JointDiagnosis` by joint, and which joints were set aside.

    Raises
    ------
    ModelError
        Where MuJoCo cannot read the model, or it has no such joint.
    RecordingError
        Where a joint has no position.
    DiagnosisError
        Where a recording does not suit, or a sensor is dead.

    See Also
    --------
    patch : Puts what was found into the model.
    """
    model = model_of(mjcf)
    all_joints = joints_of(model)
    given = [logs] if isinstance(logs, (str, Path, Recording, Mapping)) else list(logs)
    runs = [log_of(log, all_joints) for log in given]
    bodies = [RigidBody(model, Motion(all_joints, run)) for run in runs]
    names = list(dict.fromkeys(name for run in runs for name in run)) if joints is None else list(joints)
    told: dict[str, JointDiagnosis] = {}
    aside: dict[str, str] = {}
    sides: dict[str, tuple[list[Side], list[Side]]] = {}
    for name in names:
        own = joint_of(all_joints, name)
        sides[name] = _sides(model, own, [(run[name], body) for run, body in zip(runs, bodies) if name in run])
    with shown(progress) as tell:
        work = _Work(sum(bool(one) for both in sides.values() for one in both), seed, time_limit, threads, tell)
        for name, (drives, springs) in sides.items():
            drive, transmission = work.answer(f"{name}, drive", drives), work.answer(f"{name}, transmission", springs)
            if drive is None and transmission is None:
                aside[name] = "it has no motor_position with an input (command_position to a servo, or torque)"
                continue
            told[name] = _joint_told(name, drive, transmission, (springs or drives)[0].inertia)
    document = {"joints": {name: own.document for name, own in told.items()}, "set_aside": aside}
    return RobotDiagnosis(document, told, aside)


@dataclass
class _Work:
    """Diagnoses of sides, one after the other; `left` are still to come."""

    left: int
    seed: int
    time_limit: float | None
    threads: int | None
    tell: Callable[[float, str], None] | None
    done: int = 0
    start: float = field(default_factory=time.monotonic)

    def answer(self, called: str, sides: list[Side]) -> Diagnosis | None:
        """The diagnosis of one side in all runs; None where no run shows it."""
        if not sides:
            return None
        limit = None
        if self.time_limit is not None:
            limit = max(self.time_limit - (time.monotonic() - self.start), 0.0) / self.left
        told = diagnose_one(
            sides[0].model,
            [side.recording for side in sides],
            seed=self.seed,
            time_limit=limit,
            threads=self.threads,
            progress=self._part(called),
        )
        self.left, self.done = self.left - 1, self.done + 1
        return told

    def _part(self, called: str) -> Callable[[float, str], None] | bool:
        tell, done, count = self.tell, self.done, self.done + self.left
        if tell is None:
            return False
        return lambda share, what: tell((done + share) / count, f"{called}: {what}")


def _sides(model: Any, joint: Joint, here: list[tuple[Recording, RigidBody]]) -> tuple[list[Side], list[Side]]:
    """The drive's and the transmission's side of a joint in each run."""
    looks = [spring(joint, recording, body.motion, body) for recording, body in here]
    actuator = actuator_of(model, joint)
    drives = [
        drive_side(model, joint, actuator, recording, body, found is not None)
        for (recording, body), found in zip(here, looks)
    ]
    springs = [
        transmission_side(joint, recording, found, body)
        for (recording, body), found in zip(here, looks)
        if found is not None
    ]
    return [one for one in drives if one is not None], springs


def _joint_told(
    name: str, drive: Diagnosis | None, transmission: Diagnosis | None, inertia: float
) -> JointDiagnosis:
    document = {
        "joint": name,
        "inertia": inertia,
        "drive": drive.to_dict() if drive else None,
        "transmission": transmission.to_dict() if transmission else None,
    }
    return JointDiagnosis(document, name, drive, transmission, inertia)

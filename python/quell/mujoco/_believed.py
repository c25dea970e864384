"""What a model and a first look at a recording say of a joint: where the diagnosis begins."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import RecordingError
from ..model import Model
from ..recording import Channel, Recording
from ._joints import Actuator, Joint
from ._motion import Course, Motion, RigidBody

__all__ = ["Side", "Spring", "drive_side", "known_channels", "spring", "transmission_side"]

Array = NDArray[np.float64]

# A joint is in motion above this share of its greatest speed: below it, friction holds whatever it can bear.
MOVING = 0.05
# Share of the links' inertia that a rotor has at least, where the torques show none.
LEAST = 1e-3
# Standard errors by which the compliance of a joint must be above 0.
CERTAIN = 5.0
# Damping ratio of a joint of which nothing is known, and its standard deviation.
DAMPING_RATIO = 0.05


@dataclass(frozen=True)
class Side:
    """A part of a joint that is diagnosed: the model that is believed, and what it is held against."""

    model: Model
    recording: Recording
    inertia: float


@dataclass(frozen=True)
class Spring:
    """A first look at the spring of a joint: its stiffness, and the inertia behind it."""

    stiffness: float
    inertia: float


def spring(joint: Joint, recording: Recording, motion: Motion, bodies: RigidBody) -> Spring | None:
    """
    Fit `y - u = -tau / k - play sign(tau) + dt y' + offset`, the deformation over the torque that the link takes.

    None where there are not both sides, or the compliance `1 / k` is not certain.
    """
    if not {"link_position", "motor_position"} <= {channel.role for channel in recording.channels}:
        return None
    course = motion.links[joint.name]
    torque, inertia = bodies.along(joint, course.time, own=True)
    deformation = recording["link_position"].array - motion.motors[joint.name].at(course.time)[0]
    columns: Array = np.stack([-torque, -np.sign(torque), course.velocity, np.ones_like(torque)], axis=1)
    # A torque that never changes its sign shows no play.
    fitted, _, rank, _ = np.linalg.lstsq(columns, deformation, rcond=None)
    left = deformation - columns @ fitted
    squares: Array = np.asarray(columns.T @ columns, dtype=np.float64)
    variance = float(left @ left) / max(len(left) - int(rank), 1) * float(np.linalg.pinv(squares)[0, 0])
    if not float(fitted[0]) > CERTAIN * math.sqrt(variance):
        return None
    return Spring(1.0 / float(fitted[0]), float(inertia.mean()))


def transmission_side(joint: Joint, recording: Recording, found: Spring, bodies: RigidBody) -> Side:
    """The link behind its spring, driven by the motor side as it was recorded."""
    time = bodies.motion.links[joint.name].time
    force, inertia = bodies.along(joint, time, own=False)
    hertz = float(np.sqrt(found.stiffness / found.inertia)) / (2.0 * np.pi)
    lines = [
        'kind = "flexible_joint"',
        # A first look does not know what else bends: the fit has the rest to say.
        f"natural_frequency_hz = {{ value = {hertz!r}, std = {0.5 * hertz!r} }}",
        f"damping_ratio = {{ value = {DAMPING_RATIO}, std = {DAMPING_RATIO} }}",
        f"link_inertia = {{ value = {found.inertia!r}, fixed = true }}",
    ]
    motor = bodies.motion.motors[joint.name]
    # Smoothed: noise of the input would be noise of the prediction.
    prescribed = Channel(motor.position, motor.time, joint.position_unit)
    channels = {"motor_position": prescribed, "link_position": recording["link_position"]}
    known = known_channels(joint, time, -force, inertia)
    held = Recording.from_arrays({**channels, **known}, name=_named(recording, joint), payload=recording.payload)
    return Side(Model.from_toml("\n".join(lines) + "\n", joint.name), held, found.inertia)


def drive_side(
    model: Any, joint: Joint, actuator: Actuator | None, recording: Recording, bodies: RigidBody, elastic: bool
) -> Side | None:
    """The motor side, driven by what was commanded; none where that was not recorded."""
    motor = bodies.motion.motors[joint.name]
    load, inertia = bodies.along(joint, motor.time, own=elastic)
    roles = {channel.role for channel in recording.channels}
    inputs = _inputs(actuator, roles)
    if inputs is None or "motor_position" not in roles:
        return None
    torque = _torque(actuator, recording, motor, inputs)
    moves = np.abs(motor.velocity) > MOVING * np.abs(motor.velocity).max()
    inertial = np.zeros_like(load) if elastic else inertia * motor.acceleration
    rotor = _rotor(motor, torque - load - inertial, moves)
    seen = float(inertia.mean())
    rotor = max(rotor, LEAST * seen)
    lines = ['kind = "rigid_axis"', f"mass = {{ value = {rotor!r}, std = {rotor!r} }}", *_loop(actuator, inputs)]
    if inputs == ("command_position",):
        # What the servo received at each sample; a patched model is driven by it in the same way.
        lines.append('input_hold = "zero_order"')
    if (viscous := float(np.ravel(model.dof_damping)[joint.dof])) > 0.0:
        lines.append(f"viscous = {{ value = {viscous!r}, std = {viscous!r} }}")
    if (friction := float(model.dof_frictionloss[joint.dof])) > 0.0:
        lines += ["[[effect]]", 'name = "coulomb_friction"', 'place = "drive"', "[effect.parameters]"]
        lines.append(f"friction = {friction!r}")
    channels = {role: recording[role] for role in ("motor_position", "torque", "force", *inputs) if role in roles}
    known = known_channels(joint, motor.time, -load, None if elastic else inertia)
    held = Recording.from_arrays({**channels, **known}, name=_named(recording, joint), payload=recording.payload)
    return Side(Model.from_toml("\n".join(lines) + "\n", joint.name), held, seen)


def _inputs(actuator: Actuator | None, roles: set[str]) -> tuple[str, ...] | None:
    if actuator is not None and actuator.is_servo and "command_position" in roles:
        return ("command_position",)
    forces = tuple(role for role in ("torque", "force") if role in roles)
    return forces or None


def _torque(actuator: Actuator | None, recording: Recording, motor: Course, inputs: tuple[str, ...]) -> Array:
    """The drive's torque at the motor's stamps: measured, or what the servo makes of its command."""
    for role in ("torque", "force"):
        if role in recording:
            channel = recording[role]
            return np.interp(motor.time, channel.stamps, channel.array)
    if actuator is None:
        raise RecordingError(f'"{recording.name}" has neither torque nor a servo that makes it')
    channel = recording[inputs[0]]
    command = np.interp(motor.time, channel.stamps, channel.array)
    torque = actuator.position_gain * (command - motor.position) - actuator.velocity_gain * motor.velocity
    return np.clip(torque, -actuator.limit, actuator.limit)


def _rotor(motor: Course, left: Array, moves: NDArray[np.bool_]) -> float:
    """The slope of what the links leave of the torque over the acceleration, friction of both kinds left free."""
    columns = [motor.acceleration, motor.velocity, np.sign(motor.velocity), np.ones_like(left)]
    fitted = np.linalg.lstsq(np.stack(columns, axis=1)[moves], left[moves], rcond=None)[0]
    return float(fitted[0])


def _loop(actuator: Actuator | None, inputs: tuple[str, ...]) -> list[str]:
    if actuator is None or inputs != ("command_position",):
        return []
    # A servo without a velocity gain has one too small to be seen.
    velocity = max(actuator.velocity_gain, 1e-6 * actuator.position_gain)
    lines = [f"position_gain = {actuator.position_gain / velocity!r}", f"velocity_gain = {velocity!r}"]
    return [*lines, f"output_limit = {actuator.limit!r}"] if np.isfinite(actuator.limit) else lines


def known_channels(joint: Joint, time: Array, force: Array, inertia: Array | None) -> dict[str, Channel]:
    """`known_force`, and `inertia` where it is one."""
    known = {"known_force": Channel(force, time, joint.force_unit)}
    if inertia is not None and bool((inertia > 0.0).all()):
        known["inertia"] = Channel(inertia, time, "kg" if joint.slides else "kg.m^2")
    return known


def _named(recording: Recording, joint: Joint) -> str:
    return recording.name if recording.name.endswith(f"#{joint.name}") else f"{recording.name}#{joint.name}"

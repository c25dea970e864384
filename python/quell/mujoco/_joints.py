"""Joints of one degree of freedom, and what drives them."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..errors import ModelError
from ._engine import mujoco

__all__ = ["Actuator", "Joint", "actuator_of", "joint_of", "joints_of"]


@dataclass(frozen=True)
class Joint:
    """A hinge or a slide: its name, its index, and where its position and its velocity stand."""

    name: str
    index: int
    qpos: int
    dof: int
    slides: bool

    @property
    def position_unit(self) -> str:
        """The SI unit of its position."""
        return "m" if self.slides else "rad"

    @property
    def force_unit(self) -> str:
        """The SI unit of its force or torque."""
        return "N" if self.slides else "N.m"


@dataclass(frozen=True)
class Actuator:
    """
    What drives a joint, in the joint's coordinates: `F = position_gain (r - q) - velocity_gain q'`, or a force alone.

    `gear` takes the input from the joint's coordinates to those of `ctrl`: `ctrl = gear input`.
    """

    name: str
    index: int
    position_gain: float
    velocity_gain: float
    limit: float
    gear: float

    @property
    def is_servo(self) -> bool:
        """Whether its input is a position."""
        return self.position_gain > 0.0


def joints_of(model: Any) -> dict[str, Joint]:
    """All hinges and slides by name."""
    found: dict[str, Joint] = {}
    kinds = (int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE))
    for index in range(model.njnt):
        joint = model.joint(index)
        if int(joint.type[0]) in kinds and joint.name:
            qpos, dof = int(joint.qposadr[0]), int(joint.dofadr[0])
            found[joint.name] = Joint(joint.name, index, qpos, dof, int(joint.type[0]) == kinds[0])
    return found


def joint_of(joints: Mapping[str, Joint], name: str) -> Joint:
    """The joint of a name."""
    if name in joints:
        return joints[name]
    near = difflib.get_close_matches(name, joints, 1)
    meant = f'; did you mean "{near[0]}"?' if near else f" (there are {', '.join(joints) or 'none'})"
    raise ModelError(f'the model has no hinge or slide "{name}"{meant}', key=name)


def actuator_of(model: Any, joint: Joint) -> Actuator | None:
    """What drives a joint; none where nothing does, or not linearly."""
    for index in range(model.nu):
        if int(model.actuator_trntype[index]) != int(mujoco.mjtTrn.mjTRN_JOINT):
            continue
        if int(model.actuator_trnid[index, 0]) == joint.index:
            return _linear(model, index)
    return None


def _linear(model: Any, index: int) -> Actuator | None:
    gear = float(model.actuator_gear[index, 0])
    gain, bias = model.actuator_gainprm[index], model.actuator_biasprm[index]
    fixed = int(model.actuator_gaintype[index]) == int(mujoco.mjtGain.mjGAIN_FIXED)
    if not fixed or gain[0] == 0.0 or gear == 0.0:
        return None
    limit = math.inf
    if model.actuator_forcelimited[index]:
        limit = abs(gear) * float(min(-model.actuator_forcerange[index, 0], model.actuator_forcerange[index, 1]))
    name = model.actuator(index).name
    kinds = mujoco.mjtBias
    if int(model.actuator_biastype[index]) == int(kinds.mjBIAS_NONE):
        return Actuator(name, index, 0.0, 0.0, limit, 1.0 / (gear * float(gain[0])))
    is_servo = int(model.actuator_biastype[index]) == int(kinds.mjBIAS_AFFINE) and bias[1] == -gain[0]
    if not is_servo or bias[0] != 0.0:
        return None
    squared = gear * gear
    return Actuator(name, index, squared * float(gain[0]), -squared * float(bias[2]), limit, gear)

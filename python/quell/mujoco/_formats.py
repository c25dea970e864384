"""What was found, as far as Isaac Lab's actuators and URDF can hold it."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .._result import Result, bold, paragraph
from .._written import written
from ..errors import ModelError
from ..model import Effect
from ._diagnose import JointDiagnosis
from ._engine import model_of
from ._joints import actuator_of, joint_of, joints_of
from ._patch import Diagnoses, diagnoses_of

__all__ = ["Exported", "isaac_lab", "urdf"]


@dataclass(frozen=True, eq=False)
class Exported(Result):
    """
    What a format holds of what was found.

    Parameters
    ----------
    document : dict
        All of it, as `to_dict` gives it.
    text : str
        Python for Isaac Lab, XML for URDF.
    values : dict of str to dict
        Attributes by joint.
    lacks : tuple of str
        What the format cannot hold, with why.
    """

    text: str
    values: dict[str, dict[str, Any]]
    lacks: tuple[str, ...]

    def __repr__(self) -> str:
        return f"Exported({', '.join(self.values) or 'nothing'}; {len(self.lacks)} effects that it cannot hold)"

    def __str__(self) -> str:
        return self.text

    def save(self, file: str | Path) -> Path:
        """
        Write the text.

        Parameters
        ----------
        file : str or Path
            The file; it is written over.

        Returns
        -------
        Path
            The file.
        """
        return written(file, self.text)

    def _repr_html_(self) -> str:
        return bold("Exported") + f"<pre>{self.text}</pre>" + "".join(paragraph(lack) for lack in self.lacks)


@dataclass
class _Friction:
    """Friction of a joint: what holds at rest, what resists at speed, and what is in proportion to the speed."""

    static: float = 0.0
    dynamic: float = 0.0
    viscous: float = 0.0


def _friction(found: JointDiagnosis, lacks: list[str], other: Callable[[Effect], bool]) -> _Friction:
    """The friction of the motor side; what is neither that nor taken by `other` is lacking."""
    told, name = _Friction(), found.joint
    if found.drive is None:
        return told
    told.viscous = found.drive.model["viscous"]
    for effect in found.drive.model.effects:
        p = effect.parameters
        if effect.name == "viscous_friction":
            told.viscous += p["viscous"]
        elif effect.name in ("coulomb_friction", "asymmetric_friction", "stribeck_friction"):
            told.dynamic += p["friction"]
            told.static += p["friction"] * (1.0 + p.get("excess", 0.0))
            if effect.name == "asymmetric_friction":
                lacks.append(f"{name}: friction that differs between the directions (by {p['asymmetry']:+.3g} of it)")
            if effect.name == "stribeck_friction":
                speed = p["stribeck_velocity"]
                lacks.append(f"{name}: the speed over which friction falls: {speed:.3g} rad/s (m/s)")
        elif effect.name == "stiction":
            told.static += p["breakaway"]
            told.dynamic += p["breakaway"] * p["kinetic_ratio"]
        elif not other(effect):
            lacks.append(f"{name}: {effect.name} ({effect.place})")
    return told


def _springs(found: JointDiagnosis, lacks: list[str]) -> None:
    if found.transmission is None:
        return
    lacks.append(
        f"{found.joint}: its elasticity, {found.stiffness:.4g} N.m/rad (N/m): add a joint and a link without actuator"
    )
    lacks.extend(f"{found.joint}: {effect.name} ({effect.place})" for effect in found.transmission.model.effects)


def isaac_lab(mjcf: Any, diagnoses: Diagnoses, *, step: float) -> Exported:
    """
    Give what was found as actuators of Isaac Lab.

    A joint that is late is a `DelayedPDActuatorCfg`, any other an `ImplicitActuatorCfg`. `friction` (at rest),
    `dynamic_friction` and `viscous_friction` are efforts, as Isaac Sim takes them from 5.0 on.

    Parameters
    ----------
    mjcf : path, str, mujoco.MjSpec or mujoco.MjModel
        The model that was diagnosed; its servos give `stiffness` and `damping`.
    diagnoses : RobotDiagnosis, JointDiagnosis or mapping of str to JointDiagnosis
        What was found.
    step : float
        The step of the physics, s, in which a delay is counted.

    Returns
    -------
    Exported
        A dictionary of actuators, and what Isaac Lab cannot hold.

    Raises
    ------
    ModelError
        Where MuJoCo cannot read the model, it has no such joint, or the step is not above 0.
    """
    if not step > 0.0:
        raise ModelError(f"step: {step!r} is not above 0")
    model = model_of(mjcf)
    joints = joints_of(model)
    lacks: list[str] = []
    values: dict[str, dict[str, Any]] = {}
    for name, found in diagnoses_of(diagnoses).items():
        late: dict[str, Any] = {}

        def take(effect: Effect, late: dict[str, Any] = late, name: str = name) -> bool:
            if effect.name != "drive_delay":
                return False
            steps = round(effect.parameters["delay"] / step)
            late.update(min_delay=steps, max_delay=steps)
            if abs(steps * step - effect.parameters["delay"]) > 0.05 * step:
                lacks.append(f"{name}: a delay of {effect.parameters['delay']:.4g} s in whole steps is {steps * step:.4g} s")
            return True

        friction = _friction(found, lacks, take)
        _springs(found, lacks)
        actuator = actuator_of(model, joint_of(joints, name))
        own: dict[str, Any] = {"joint_names_expr": [name]}
        if actuator is not None and actuator.is_servo:
            own.update(stiffness=actuator.position_gain, damping=actuator.velocity_gain)
        else:
            own.update(stiffness=0.0, damping=0.0)
        own.update(
            armature=found.armature,
            friction=friction.static,
            dynamic_friction=friction.dynamic,
            viscous_friction=friction.viscous,
            **late,
        )
        values[name] = own
    return _exported(_python(values), values, lacks)


def _python(values: dict[str, dict[str, Any]]) -> str:
    used = sorted({_kind(own) for own in values.values()})
    lines = [f"from isaaclab.actuators import {', '.join(used)}", "", "actuators = {"]
    for name, own in values.items():
        lines.append(f"    {name!r}: {_kind(own)}(")
        lines += [f"        {key}={value!r}," for key, value in own.items() if value is not None]
        lines.append("    ),")
    return "\n".join([*lines, "}", ""])


def _kind(own: dict[str, Any]) -> str:
    return "DelayedPDActuatorCfg" if "min_delay" in own else "ImplicitActuatorCfg"


def urdf(description: str | Path, diagnoses: Diagnoses) -> Exported:
    """
    Put what was found into the `<dynamics>` of a URDF.

    `damping` and `friction` are all that the tag has: the latter is what resists at speed.

    Parameters
    ----------
    description : str or Path
        The URDF: a path, or its text. Its joints are called as those of the MJCF.
    diagnoses : RobotDiagnosis, JointDiagnosis or mapping of str to JointDiagnosis
        What was found.

    Returns
    -------
    Exported
        The URDF, and what it cannot hold.

    Raises
    ------
    ModelError
        Where the URDF cannot be read, or has no such joint.
    """
    given = str(description)
    try:
        text = given if "<" in given else Path(given).read_text(encoding="utf-8")
        root = ElementTree.fromstring(text)
    except (OSError, ElementTree.ParseError) as error:
        raise ModelError(f"the URDF cannot be read: {error}") from error
    joints = {joint.get("name"): joint for joint in root.findall("joint")}
    lacks: list[str] = []
    values: dict[str, dict[str, Any]] = {}
    for name, found in diagnoses_of(diagnoses).items():
        joint = joints.get(name)
        if joint is None:
            raise ModelError(f'the URDF has no joint "{name}"', key=name)
        friction = _friction(found, lacks, lambda _: False)
        _springs(found, lacks)
        if found.armature is not None:
            lacks.append(f"{name}: the inertia of the motor, {found.armature:.4g} kg.m^2 (kg)")
        if friction.static > friction.dynamic:
            lacks.append(f"{name}: friction at rest of {friction.static:.4g} N.m (N), above that at speed")
        own = {"damping": friction.viscous, "friction": friction.dynamic}
        dynamics = joint.find("dynamics")
        if dynamics is None:
            dynamics = ElementTree.SubElement(joint, "dynamics")
        for key, value in own.items():
            dynamics.set(key, repr(value))
        values[name] = own
    return _exported(ElementTree.tostring(root, encoding="unicode") + "\n", values, lacks)


def _exported(text: str, values: dict[str, dict[str, Any]], lacks: list[str]) -> Exported:
    document = {"text": text, "values": values, "lacks": lacks}
    return Exported(document, text, values, tuple(lacks))

"""What was found, put into a MuJoCo model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Union

import numpy as np

from ..model import Effect
from ._diagnose import JointDiagnosis, RobotDiagnosis
from ._engine import mujoco, spec_of
from ._joints import actuator_of, joint_of, joints_of
from ._laws import Friction, Law, about_zero, friction_of, resistance_of
from ._patched import Change, Patched

__all__ = ["Diagnoses", "diagnoses_of", "patch"]

# A limit whose impedance is so small is a spring of known stiffness: see `_Patch.play`.
IMPEDANCE = 1e-4

Diagnoses = Union[RobotDiagnosis, JointDiagnosis, Mapping[str, JointDiagnosis]]


def diagnoses_of(diagnoses: Diagnoses) -> dict[str, JointDiagnosis]:
    """Diagnoses by joint."""
    if isinstance(diagnoses, RobotDiagnosis):
        return diagnoses.joints
    if isinstance(diagnoses, JointDiagnosis):
        return {diagnoses.joint: diagnoses}
    return dict(diagnoses)


def patch(mjcf: Any, diagnoses: Diagnoses) -> Patched:
    """
    Put what was found into a MuJoCo model.

    The motor side is the joint itself: `armature`, `damping`, `frictionloss`; delay and lag are of its actuator
    (`delay`, `dyntype="filterexact"`). An elastic joint gets a second joint of the same axis, `NAME_bend`, with
    `stiffness` and `damping`; the link stands at the sum of both. Backlash is that joint's `range`, whose ends are as
    stiff as the transmission. A law that MJCF has no element for is a table for a callback.

    Parameters
    ----------
    mjcf : path, str or mujoco.MjSpec
        The model that was diagnosed.
    diagnoses : RobotDiagnosis, JointDiagnosis or mapping of str to JointDiagnosis
        What was found.

    Returns
    -------
    Patched
        The MJCF, what has changed, the laws, and what MuJoCo cannot hold.

    Raises
    ------
    ModelError
        Where MuJoCo cannot read the model, or it has no such joint.
    """
    work = _Patch(mjcf)
    for joint in diagnoses_of(diagnoses).values():
        work.joint(joint)
    return work.done()


class _Patch:
    """A specification that is being patched."""

    def __init__(self, mjcf: Any) -> None:
        self.spec = spec_of(mjcf)
        self.model = self.spec.copy().compile()
        self.joints = joints_of(self.model)
        self.changes: dict[tuple[str, str], Change] = {}
        self.laws: list[Law] = []
        self.lacks: list[str] = []
        self.bends: dict[str, str] = {}
        # Stiffness and damping of the ends of a play, which need the compiled model.
        self.ends: dict[str, tuple[float, float]] = {}

    def joint(self, found: JointDiagnosis) -> None:
        joint = joint_of(self.joints, found.joint)
        element = self.spec.joint(joint.name)
        if found.drive is not None:
            self.set(element, "armature", found.drive.model["mass"], "inertia of the motor")
            viscous = found.drive.model["viscous"] + _of(found, "viscous_friction", "viscous")
            self.set(element, "damping", _first(element.damping, viscous), "viscous friction")
            self.set(element, "frictionloss", 0.0, "see the friction that was found")
            for effect in found.drive.model.effects:
                self.drive(found, element, effect)
        if found.transmission is not None and found.stiffness and found.spring_damping is not None:
            self.transmission(found, element)

    def set(self, element: Any, attribute: str, value: Any, why: str, kind: str = "joint") -> None:
        before = np.copy(getattr(element, attribute))
        if np.array_equal(before, value):
            return
        setattr(element, attribute, value)
        place = f"{kind} {element.name}", attribute
        given = self.changes[place].before if place in self.changes else _text(before)
        self.changes[place] = Change(*place, given, _text(value), why)

    def drive(self, found: JointDiagnosis, element: Any, effect: Effect) -> None:
        """An effect of the motor side, or of a link that is rigidly behind it."""
        name, p = effect.name, effect.parameters
        if name == "viscous_friction":
            return
        if effect.place == "drive" and name in ("drive_delay", "drive_lag", "saturation"):
            self.actuator(found.joint, name, p)
        elif name == "viscous_drag":
            self.set(element, "damping", _first(element.damping, element.damping[0] + p["viscous"]), name)
        elif name == "quadratic_drag":
            # Shape of an odd damping polynomial: v, v |v|, v^3.
            self.set(element, "damping", np.array([element.damping[0], p["coefficient"], element.damping[2]]), name)
        else:
            self.force(found.joint, (element.name,), element, effect, 1.0, 0.0)

    def actuator(self, joint: str, name: str, p: Mapping[str, float]) -> None:
        """Delay or lag of what the actuator is asked for, or the limit of what it gives."""
        actuator = actuator_of(self.model, self.joints[joint])
        if actuator is None:
            self.lacks.append(f"{joint}: {name}: the joint has no actuator that could have it")
            return
        element = self.spec.actuators[actuator.index]
        if name == "saturation":
            limit = p["limit"] / abs(float(self.model.actuator_gear[actuator.index, 0]))
            self.set(element, "forcerange", np.array([-limit, limit]), name, "actuator")
            element.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
            return
        step = float(self.model.opt.timestep)
        looks_within = int(self.model.opt.integrator) == int(mujoco.mjtIntegrator.mjINT_RK4)
        if name == "drive_delay":
            # Linear, so that the delay need not be a number of steps. A control that is held within each step is half a
            # step later than the line through its values, which only an integrator that looks within the step sees.
            delay = p["delay"] + (0.5 * step if looks_within else 0.0)
            self.set(element, "nsample", int(np.ceil(delay / step)) + 2, name, "actuator")
            self.set(element, "interp", 1, name, "actuator")
            self.set(element, "delay", delay, name, "actuator")
            return
        if int(self.model.actuator_dyntype[actuator.index]) != int(mujoco.mjtDyn.mjDYN_NONE):
            self.lacks.append(f"{joint}: {name}: the actuator has dynamics of its own already")
            return
        # The exact filter goes by whole steps, which such an integrator sees as half a step more.
        kinds = mujoco.mjtDyn
        kind = kinds.mjDYN_FILTER if looks_within else kinds.mjDYN_FILTEREXACT
        self.set(element, "dyntype", kind, name, "actuator")
        self.set(element, "dynprm", _first(element.dynprm, p["time_constant"]), name, "actuator")

    def transmission(self, found: JointDiagnosis, element: Any) -> None:
        """A second joint of the same axis: the deformation."""
        model = found.transmission.model if found.transmission else None
        stiffness, damping = found.stiffness, found.spring_damping
        if model is None or stiffness is None or damping is None:
            return
        if self.spec.joint(element.name).parent.joints[-1].name != element.name:
            self.lacks.append(f"{found.joint}: its elasticity: another joint of the same body stands behind it")
            return
        name = f"{element.name}_bend"
        bend = element.parent.add_joint(name=name, type=element.type, axis=element.axis, pos=element.pos)
        self.bends[element.name] = name
        gaps = [effect for effect in model.effects if effect.name == "backlash"]
        share = gaps[0].parameters.get("damping_in_gap", 0.0) if gaps else 1.0
        self.set(bend, "damping", np.array([damping * share, 0.0, 0.0]), "damping across the transmission")
        if gaps:
            self.play(bend, gaps[0].parameters["gap"], (stiffness, damping * (1.0 - share)))
        else:
            self.set(bend, "stiffness", np.array([stiffness, 0.0, 0.0]), "stiffness of the transmission")
        for effect in model.effects:
            if effect.name != "backlash":
                self.bent(found, element, bend, effect, stiffness)

    def play(self, bend: Any, gap: float, ends: tuple[float, float]) -> None:
        """
        A range, whose ends push as a spring and a damper of known size, and never pull.

        A constraint pushes with `f = d (a_ref - a_0) / A`, `a_ref = -b v - k r`, as its impedance `d` goes to 0, `A` the
        inverse inertia at the reference pose: so `k = K A / d` is a spring `K`, whatever the pose. MuJoCo divides `k` and
        `b` of the direct format by `d^2` and `d`, and multiplies `k` by `d`: `k = K A`, `b = C A`.
        """
        degrees = bool(bend.compiler.degree) and bend.type == mujoco.mjtJoint.mjJNT_HINGE
        half = 0.5 * gap * (180.0 / np.pi if degrees else 1.0)
        self.set(bend, "range", np.array([-half, half]), "backlash")
        bend.limited = mujoco.mjtLimited.mjLIMITED_TRUE
        impedance = np.array([IMPEDANCE, IMPEDANCE, 1.0, 0.5, 1.0])
        self.set(bend, "solimp_limit", impedance, "ends as stiff as the transmission")
        self.ends[bend.name] = ends

    def bent(self, found: JointDiagnosis, element: Any, bend: Any, effect: Effect, stiffness: float) -> None:
        """A further effect of the transmission, or of the link behind it; forces are in units of its stiffness."""
        name, p = effect.name, effect.parameters
        if name == "cubic_stiffness" and effect.place == "transmission":
            value = np.array([bend.stiffness[0], 0.0, stiffness * p["k3"]])
            self.set(bend, "stiffness", value, name)
        elif name == "quadratic_damping":
            value = np.array([bend.damping[0], stiffness * p["coefficient"], 0.0])
            self.set(bend, "damping", value, name)
        else:
            own = (bend.name,) if effect.place == "transmission" else (element.name, bend.name)
            self.force(found.joint, own, bend, effect, stiffness, stiffness)

    def force(
        self, joint: str, own: tuple[str, ...], element: Any, effect: Effect, scale: float, stiffness: float
    ) -> None:
        """A force that is the element's own, a table, or neither."""
        if effect.place in ("sensor", "base", "environment"):
            self.lacks.append(f"{joint}: {effect.name}: it is not the joint's ({effect.place}); the model is left as it is")
            return
        friction = friction_of(effect.name, effect.parameters, scale)
        if friction is not None:
            kind = "joint"
            if len(own) > 1:
                element, kind = self.sum_of(own), "tendon"
            self.friction(element, own, effect.name, friction, kind)
            return
        law = resistance_of(effect.name, effect.parameters, scale, stiffness)
        if law is None:
            self.lacks.append(f"{joint}: {effect.name}: neither an element of MJCF nor a table over position or velocity")
            return
        self.laws.append(Law(own, law.coordinate, law.points, -law.law(law.points), effect.name))

    def sum_of(self, own: tuple[str, ...]) -> Any:
        """A tendon as long as the link has turned: friction against the ground."""
        name = f"{own[0]}_link"
        tendon = self.spec.tendon(name)
        if tendon is None:
            tendon = self.spec.add_tendon(name=name)
            for joint in own:
                tendon.wrap_joint(joint, 1.0)
        return tendon

    def friction(self, element: Any, own: tuple[str, ...], effect: str, friction: Friction, kind: str) -> None:
        step = float(self.model.opt.timestep)
        self.set(element, "frictionloss", element.frictionloss + friction.loss, effect, kind)
        # With MuJoCo's default impedance a joint creeps below its friction.
        self.set(element, "solref_friction", np.array([2.0 * step, 1.0]), "sticks, does not creep", kind)
        impedance = np.array([0.9999, 0.9999, 0.001, 0.5, 2.0])
        self.set(element, "solimp_friction", impedance, "sticks, does not creep", kind)
        if friction.added is not None:
            points = about_zero(friction.width)
            self.laws.append(Law(own, "velocity", points, friction.added(points), effect))

    def done(self) -> Patched:
        if self.ends:
            model = self.spec.copy().compile()
            for name, (stiffness, damping) in self.ends.items():
                inverse = float(model.dof_invweight0[int(model.joint(name).dofadr[0])])
                solref = -np.array([stiffness, max(damping, 1e-9 * stiffness)]) * inverse
                self.set(self.spec.joint(name), "solref_limit", solref, "stiffness and damping of the transmission")
        self.spec.compile()
        changes = tuple(change for change in self.changes.values() if change.before != change.after)
        xml = self.spec.to_xml()
        document = {
            "xml": xml,
            "changes": [vars(change) for change in changes],
            "laws": [law.to_dict() for law in self.laws],
            "lacks": self.lacks,
            "bends": self.bends,
        }
        return Patched(document, xml, changes, tuple(self.laws), tuple(self.lacks), self.bends, self.spec)


def _of(found: JointDiagnosis, effect: str, parameter: str) -> float:
    """The sum of a parameter of an effect of the drive's better model."""
    effects = found.drive.model.effects if found.drive else ()
    return sum(one.parameters[parameter] for one in effects if one.name == effect)


def _first(values: Any, first: float) -> Any:
    """The same array with another first value."""
    changed = np.array(values, dtype=float)
    changed[0] = first
    return changed


def _text(value: Any) -> str:
    texts = [f"{one:.6g}" if isinstance(one, (int, float)) else str(one) for one in np.ravel(value).tolist()]
    while len(texts) > 1 and texts[-1] == "0":
        texts.pop()
    return " ".join(texts)

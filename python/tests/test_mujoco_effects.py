"""Each effect that a patch holds: MuJoCo predicts with it what Quell predicts with it."""

from __future__ import annotations

import numpy as np
import pytest
import quell

pytest.importorskip("mujoco", reason="MuJoCo is not installed: its tests are skipped")

import quell.mujoco  # noqa: E402
from quell.mujoco import JointDiagnosis  # noqa: E402

RATE = 500.0
INERTIA, STIFFNESS, DAMPING = 3.0, 15000.0, 40.0
MJCF = f"""
<mujoco><compiler angle="radian"/><option timestep="0.0005" integrator="RK4"/>
<worldbody><body><inertial pos="0 0 0" mass="5" diaginertia="2 2 {INERTIA}"/>
<joint name="turn" axis="0 0 1" armature="2" damping="5"/></body></worldbody>
<actuator><position name="servo" joint="turn" kp="9000" kv="400"/></actuator></mujoco>
"""
DRIVE = 'kind = "rigid_axis"\nmass = 2.0\nviscous = 5.0\nposition_gain = 22.5\nvelocity_gain = 400.0\n'
W = float(np.sqrt(STIFFNESS / INERTIA))
TRANSMISSION = (
    f'kind = "flexible_joint"\nnatural_frequency_hz = {W / 2 / np.pi!r}\n'
    f"damping_ratio = {DAMPING / (2 * W * INERTIA)!r}\nlink_inertia = {{ value = {INERTIA}, fixed = true }}\n"
)
LEVELS = [12, 11, 10.5, 10.2, 10.1, 10, 9, 9.1, 9.2, 9.5, 10, 11]
CURVE = [0.3, 0.1, -0.4, 0.2, 0.6, 0.1, -0.3, -0.5, 0.2, 0.5, 0.1, -0.2]
# Name, place, parameters.
DRIVES = [
    ("coulomb_friction", "drive", {"friction": 10.0}),
    ("stribeck_friction", "drive", {"friction": 8.0, "excess": 0.5, "stribeck_velocity": 0.1}),
    ("asymmetric_friction", "drive", {"friction": 8.0, "asymmetry": 0.3}),
    ("smooth_coulomb_friction", "drive", {"friction": 8.0, "transition_velocity": 0.05}),
    ("learned_friction", "drive", {"values": LEVELS, "from": -1.5, "to": 1.5}),
    ("viscous_friction", "drive", {"viscous": 12.0}),
    ("cogging", "drive", {"amplitude": 4.0, "order": 20.0, "phase": 0.4}),
    ("learned_position_force", "drive", {"values": CURVE, "from": -0.7, "to": 0.9}),
    ("saturation", "drive", {"limit": 25.0}),
    ("drive_delay", "drive", {"delay": 0.0093}),
    ("drive_lag", "drive", {"time_constant": 0.01}),
    ("quadratic_drag", "link", {"coefficient": 6.0}),
    ("viscous_drag", "link", {"viscous": 6.0}),
]
TRANSMISSIONS = [
    ("", "", {}),
    ("backlash", "transmission", {"gap": 1e-3}),
    ("backlash", "transmission", {"gap": 1e-3, "damping_in_gap": 0.5}),
    ("coulomb_friction", "transmission", {"friction": 2e-4}),
    ("coulomb_friction", "link", {"friction": 3e-4}),
    ("cubic_stiffness", "transmission", {"k3": 3e4}),
    ("bilinear_stiffness", "transmission", {"change": 0.5, "knee": 5e-4, "asymmetry": 0.2}),
    ("quadratic_damping", "transmission", {"coefficient": 0.02}),
    ("quadratic_drag", "link", {"coefficient": 4e-4}),
    ("gravity_load", "link", {"amplitude": 5e-4, "phase": 0.3}),
]


# Samples at the beginning, in which all comes to rest.
SETTLES = 400


class Side:
    """A side of a joint whose model is known, and the same without its effect."""

    def __init__(self, base: str, effect: tuple[str, str, dict[str, object]]) -> None:
        name, place, parameters = effect
        lines = [f"{key} = {value}" for key, value in parameters.items()]
        table = ["[[effect]]", f'name = "{name}"', f'place = "{place}"', "[effect.parameters]", *lines]
        self.without = quell.Model.from_toml(base)
        self.model = quell.Model.from_toml(base + "\n".join(table) + "\n") if name else self.without
        self.findings, self.summary = (), ""


def motion() -> np.ndarray:
    """Moves and rests."""
    limits, at, parts = quell.Limits(1.2, 9.0, 150.0), 0.0, [np.zeros(SETTLES + 50)]
    for target in (0.8, 0.1, 0.5, -0.6, 0.0):
        one = quell.plan(at, target, limits, rate=RATE)
        parts += [one.position[1:], np.full(60, target)]
        at = target
    return np.concatenate(parts)


def recorded(roles: dict[str, np.ndarray]) -> quell.Recording:
    """A recording of angles, with the inertia that the joint sees."""
    count = len(next(iter(roles.values())))
    inertia = quell.Channel(np.full(count, INERTIA), np.arange(count) / RATE, "kg.m^2")
    return quell.Recording.from_arrays({**roles, "inertia": inertia}, rate=RATE, units=dict.fromkeys(roles, "rad"))


def check(side: Side, diagnosis: object, wanted: dict[str, np.ndarray], role: str, how: str) -> None:
    """Patched MuJoCo against Quell, over what the effect does."""
    patched = quell.mujoco.patch(MJCF, diagnosis)  # type: ignore[arg-type]
    assert not patched.lacks
    # What MuJoCo makes of the input is the recording, from where it is at rest.
    first = quell.mujoco.simulate(patched, recorded({**wanted, role: next(iter(wanted.values()))}), "turn", input=how)  # type: ignore[arg-type]
    truth = {name: values[SETTLES:] for name, values in {**wanted, role: first[role].predicted}.items()}
    recording = recorded(truth)
    told = quell.mujoco.simulate(patched, recording, "turn", input=how)[role].predicted  # type: ignore[arg-type]
    with_it, without = (quell.simulate(model, recording).outputs[0].predicted for model in (side.model, side.without))
    size, left = np.std(with_it - without), np.std(with_it - told)
    assert left < 0.02 * size + 4e-6, (left, size)


@pytest.mark.parametrize("effect", DRIVES, ids=lambda effect: effect[0])
def test_a_drive(effect: tuple[str, str, dict[str, object]]) -> None:
    side = Side(DRIVE, effect)
    joint = JointDiagnosis({}, "turn", side, None, INERTIA)  # type: ignore[arg-type]
    command = motion()
    check(side, joint, {"command_position": command}, "motor_position", "command")


@pytest.mark.parametrize("effect", TRANSMISSIONS, ids=lambda effect: f"{effect[0]}-{effect[1]}")
def test_a_transmission(effect: tuple[str, str, dict[str, object]]) -> None:
    side = Side(TRANSMISSION, effect)
    joint = JointDiagnosis({}, "turn", None, side, INERTIA)  # type: ignore[arg-type]
    check(side, joint, {"motor_position": motion()}, "link_position", "motor")

"""A six-axis arm of the tests' own, and recordings of it with physics that its description lacks."""

from __future__ import annotations

from dataclasses import dataclass, field

import mujoco
import numpy as np

import quell

# Name, offset of the body, axis, mass, centre of mass, inertia about it, position gain, velocity gain, armature, damping.
LINKS = [
    ("base", "0 0 0.3", "0 0 1", 18.0, "0 -0.03 0.12", "0.25 0.2 0.22", 12000.0, 600.0, 4.0, 8.0),
    ("shoulder", "0.12 0 0.25", "0 1 0", 14.0, "0.02 0 0.32", "0.62 0.6 0.08", 20000.0, 1000.0, 5.0, 10.0),
    ("elbow", "0 0 0.62", "0 1 0", 8.0, "0.1 0 0.06", "0.06 0.12 0.1", 9000.0, 400.0, 1.8, 5.0),
    ("forearm", "0.32 0 0.1", "1 0 0", 5.0, "0.14 0 0", "0.015 0.07 0.07", 2500.0, 90.0, 0.4, 1.2),
    ("wrist", "0.32 0 0", "0 1 0", 2.2, "0.04 0 0", "0.006 0.008 0.008", 1500.0, 50.0, 0.25, 0.8),
    ("flange", "0.1 0 0", "1 0 0", 1.2, "0.05 0 0.01", "0.003 0.003 0.003", 800.0, 25.0, 0.12, 0.4),
]
HOME = [0.0, 0.3, 0.5, 0.0, 0.4, 0.0]
RATE = 500.0
# Noise of the encoder behind the motor and of that at the link (rad), and of torques as a share of the greatest.
MOTOR, LINK, TORQUE = 5e-6, 1e-5, 2e-3
STEP = 0.0005


@dataclass(frozen=True)
class Hidden:
    """What a joint has and the description does not, in SI."""

    stiffness: float = 0.0
    spring_damping: float = 0.0
    gap: float = 0.0
    friction: float = 0.0
    excess: float = 0.0
    stribeck: float = 1.0
    delay: float = 0.0


NAMES = [link[0] for link in LINKS]


def mjcf(timestep: float = STEP) -> str:
    """The description that somebody believes in."""
    opened, joints, actuators = "", [], ""
    for name, pos, axis, mass, com, inertia, kp, kv, armature, damping in LINKS:
        joint = f'<joint name="{name}" axis="{axis}" armature="{armature}" damping="{damping}"/>'
        opened += f'<body name="{name}_link" pos="{pos}"><inertial pos="{com}" mass="{mass}" diaginertia="{inertia}"/>'
        opened += joint
        actuators += f'<position name="{name}" joint="{name}" kp="{kp}" kv="{kv}"/>'
        joints.append(joint)
    return (
        f'<mujoco model="six_axes"><compiler angle="radian"/><option timestep="{timestep}" integrator="RK4"/>'
        f"<worldbody>{opened}{'</body>' * len(LINKS)}</worldbody><actuator>{actuators}</actuator></mujoco>"
    )


def _machine(hidden: dict[str, Hidden]) -> str:
    """The description with the joints that bend, or have play: motor side and deformation."""
    text, tendons = mjcf(), ""
    for name, own in hidden.items():
        if own.stiffness > 0.0:
            link = next(link for link in LINKS if link[0] == name)
            spring = f'stiffness="{own.stiffness}"' if own.gap == 0.0 else ""
            bend = f'<joint name="{name}_bend" axis="{link[2]}" damping="{own.spring_damping}" {spring}/>'
            at = text.index("/>", text.index(f'<joint name="{name}"')) + 2
            text = text[:at] + bend + text[at:]
        if own.gap > 0.0:
            play = f'springlength="{-0.5 * own.gap} {0.5 * own.gap}" stiffness="{own.stiffness}"'
            tendons += f'<fixed {play}><joint joint="{name}_bend" coef="1"/></fixed>'
    # Dry friction that sticks: MuJoCo's own creeps with its default impedance.
    stiff = f'frictionloss="1e-9" solreffriction="{2 * STEP} 1" solimpfriction="0.9999 0.9999 0.001"'
    for name in NAMES:
        text = text.replace(f'<joint name="{name}" ', f'<joint name="{name}" {stiff} ')
    return text.replace("<actuator>", f"<tendon>{tendons}</tendon><actuator>")


def commands(seconds: float, seed: int, size: float = 0.7) -> np.ndarray:
    """Moves of the seventh order from rest to rest, of all joints out of step, shape (n, 6)."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * RATE)) / RATE
    all_joints = np.empty((len(time), len(LINKS)))
    for joint, home in enumerate(HOME):
        position, start, at = np.full(len(time), home), 0.3, home
        while start < seconds - 1.0:
            target, lasts = home + rng.uniform(-size, size), rng.uniform(0.8, 1.7)
            s = np.clip((time - start) / lasts, 0.0, 1.0)
            position += (target - at) * s**4 * (35 - 84 * s + 70 * s**2 - 20 * s**3)
            start, at = start + lasts + rng.uniform(0.05, 0.4), target
        all_joints[:, joint] = position
    return all_joints


def record(hidden: dict[str, Hidden], seconds: float = 8.0, seed: int = 1) -> dict[str, quell.Recording]:
    """Recordings of all joints: command, encoder, torque, and the link where it bends."""
    model = mujoco.MjModel.from_xml_string(_machine(hidden))
    data = mujoco.MjData(model)
    motors = [model.joint(name) for name in NAMES]
    bends = {name: model.joint(f"{name}_bend") for name, own in hidden.items() if own.stiffness > 0.0}
    wanted = commands(seconds, seed)
    every = round(1.0 / RATE / STEP)
    for motor, home in zip(motors, HOME):
        data.qpos[motor.qposadr[0]] = home
    rows = []
    for tick in range(-int(0.5 * RATE) * every, len(wanted) * every):
        for j, (name, motor) in enumerate(zip(NAMES, motors)):
            own = hidden.get(name, Hidden())
            sample = (tick - round(own.delay / STEP)) // every
            data.ctrl[j] = wanted[max(sample, 0), j]
            speed = data.qvel[motor.dofadr[0]] / own.stribeck
            friction = own.friction * (1.0 + own.excess * np.exp(-speed * speed))
            model.dof_frictionloss[motor.dofadr[0]] = max(friction, 1e-9)
        if tick >= 0 and tick % every == 0:
            mujoco.mj_forward(model, data)
            q = [data.qpos[motor.qposadr[0]] for motor in motors]
            rows.append((q, data.actuator_force.copy(), [data.qpos[b.qposadr[0]] for b in bends.values()]))
        mujoco.mj_step(model, data)
    q, torque, bent = (np.array(column) for column in zip(*rows))
    return _noisy(wanted, q, torque, dict(zip(bends, bent.T)), seed)


def _noisy(
    wanted: np.ndarray, q: np.ndarray, torque: np.ndarray, bent: dict[str, np.ndarray], seed: int
) -> dict[str, quell.Recording]:
    rng, told = np.random.default_rng(1000 + seed), {}
    units = {"command_position": "rad", "motor_position": "rad", "link_position": "rad", "torque": "N.m"}
    for j, name in enumerate(NAMES):
        noise = rng.standard_normal((3, len(q)))
        channels = {
            "command_position": wanted[:, j],
            "motor_position": q[:, j] + MOTOR * noise[0],
            "torque": torque[:, j] + TORQUE * np.abs(torque[:, j]).max() * noise[1],
        }
        if name in bent:
            channels["link_position"] = q[:, j] + bent[name] + LINK * noise[2]
        told[name] = quell.Recording.from_arrays(channels, rate=RATE, units=units, name=f"run {seed}")
    return told

"""Runs an arm through a programme: one engine step at a time, with the effects' hooks in between."""

import mujoco
import numpy as np

from motion import reference

KEEP_S = 1e-4              # states are kept at least this far apart
SETTLE_S = 0.4             # of rest before the clock starts; 14 time constants of a 5.5 Hz arm


class Unstable(Exception):
    """The engine gave up on a state."""


class Run:
    """States of the arm at engine steps: times (n), motor position (n), deformation (n), tip (n, 3), link angle (n)."""

    def __init__(self, time, motor, deformation, tip, angle):
        self.time, self.motor, self.deformation, self.tip, self.angle = time, motor, deformation, tip, angle


def simulate(arm, programme, hooks):
    """Steps `arm` through `programme`; each hook(t, dt, e, de, u, du, model) returns torque across the joint and on the link."""
    model = arm.compile()
    dt = arm.timestep
    time = np.arange(int(round(programme["duration_s"] / dt)) + 1) * dt
    command = reference(programme["moves"], time + dt / 2)
    # Extra actuators follow the commanded position through a law of their own.
    extra = [arm.laws[model.actuator(i).name](command[0]) for i in range(2, model.nu)]
    control = np.column_stack([command[0] + arm.home, command[1], *extra])
    data = mujoco.MjData(model)
    data.qpos[model.joint("motor").qposadr[0]] = arm.home
    for actuator in range(2, model.nu):
        data.qpos[model.jnt_qposadr[model.actuator_trnid[actuator, 0]]] = control[0, actuator]
    data.ctrl[:] = control[0]
    mujoco.mj_forward(model, data)      # hooks look at the acceleration, so it has to be that of an arm at rest

    # Static loads have to be in balance before the clock starts: a critically damped rest at time 0.
    joint = model.joint("flex")
    damping = float(joint.damping[0])
    joint.damping[0] = 2 * np.sqrt(arm.stiffness * arm.inertia)
    advance(model, data, hooks, np.tile(control[0], (int(round(SETTLE_S / dt)), 1)), at_rest=True)
    joint.damping[0] = damping
    states = advance(model, data, hooks, control)
    if any(warning.number for warning in data.warning):
        raise Unstable("the engine became unstable; its own reset would hide it")
    stride = keep_every(dt)
    tip, angle = kinematics(model, states)
    motor, flex = (model.joint(name).qposadr[0] for name in ("motor", "flex"))
    return Run(time[::stride], states[:, motor], states[:, flex], tip, angle)


def keep_every(dt):
    """Number of steps from one kept state to the next."""
    return max(1, int(round(KEEP_S / dt)))


def advance(model, data, hooks, control, at_rest=False):
    """One engine step for each row of `control`; returns the states before every so many steps.

    A hook's torque is held over the step and evaluated at its predicted middle, so that it is of second order in the step.
    Rates are those of the last two steps on the average, carried on: the servo's command is held over a step, so that within
    each the motor runs ahead and falls back, and its rate between steps is off by (servo dt)^2 / 12 of the speed.
    """
    dt = model.opt.timestep
    half, stride, step = dt / 2, keep_every(dt), mujoco.mj_step
    motor, flex = (model.joint(name).qposadr[0] for name in ("motor", "flex"))
    dof_motor, dof_flex = (model.joint(name).dofadr[0] for name in ("motor", "flex"))
    qpos, qvel, applied, ctrl = data.qpos, data.qvel, data.qfrc_applied, data.ctrl
    states = np.empty(((len(control) - 1) // stride + 1, model.nq))
    last_u, last_e, mean_du, mean_de = float(qpos[motor]), float(qpos[flex]), float(qvel[dof_motor]), float(qvel[dof_flex])
    for i, row in enumerate(control):
        if i % stride == 0:
            states[i // stride] = qpos
        if hooks:
            t = half if at_rest else i * dt + half
            u, e = float(qpos[motor]), float(qpos[flex])
            new_du, new_de = ((u - last_u) / dt, (e - last_e) / dt) if i else (mean_du, mean_de)
            du, de = 2 * new_du - mean_du, 2 * new_de - mean_de
            last_u, last_e, mean_du, mean_de = u, e, new_du, new_de
            u, e = u + half * du, e + half * de
            across = on_link = 0.0
            for hook in hooks:
                torques = hook(t, dt, e, de, u, du, model)
                across += torques[0]
                on_link += torques[1]
            applied[dof_flex] = across + on_link
            applied[dof_motor] = on_link
        ctrl[:] = row
        step(model, data)
    return states


def kinematics(model, states):
    """Tip position and link yaw for every state."""
    data = mujoco.MjData(model)
    site, link = model.site("tip").id, model.body("link").id
    tip, yaw = np.empty((len(states), 3)), np.empty(len(states))
    position, turn, qpos = data.site_xpos[site], data.xmat[link], data.qpos
    for i, state in enumerate(states):
        qpos[:] = state
        mujoco.mj_kinematics(model, data)
        tip[i] = position
        yaw[i] = np.arctan2(turn[3], turn[0])
    return tip, yaw

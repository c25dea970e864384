#!/usr/bin/env python3
"""An arm of MuJoCo with a second mode, or a mode that follows the pose, over UDP at 1 kHz.

Clock, network, playback and sensors are those of `udp_arm.py`; the dynamics are the engine's. `--arm two`: two elastic joints in
series, which ring at 8 and 19 Hz. `--arm pose`: one elastic joint, and a load that an axis of its own draws inwards as the joint
turns: 8 Hz at 0 degrees, 11 Hz at 60. After each move a line goes to stdout, as `udp_arm.py` says it; its residual is the largest
true deformation in half a second after the servo has followed, rad.
"""

import json
import math
import sys

import mujoco
import udp_arm

# Steps of the engine in one of the robot.
STEPS = 4
# So long the arm is watched after the servo has followed, s.
WATCHED = 0.5
SERVO = 2 * math.pi * 150.0
MOTOR_INERTIA = 50.0
DAMPING = 0.03
# Inertia of the link, kg m^2, and the load that slides on it, kg.
LINK, LOAD = 10.0, 20.0
FIRST, LAST, RANGE = 8.0, 11.0, math.radians(60.0)
# Distance of the load at 0 degrees, m.
FAR = 1.0


def square(hertz):
    return (2 * math.pi * hertz) ** 2


def elastic(name, stiffness, inertia, hertz):
    damping = 2 * DAMPING * stiffness / (2 * math.pi * hertz)
    return f'<joint name="{name}" axis="0 0 1" stiffness="{stiffness}" damping="{damping}"/>' + inertia


def inertial(spin, mass=1.0):
    return f'<inertial pos="0 0 0" mass="{mass}" diaginertia="{spin} {spin} {spin}"/>'


def two():
    """Inertias 1 and j in series: with springs k and c the squares s of both frequencies have
    s^2 - s (k + c + c / j) + k c / j = 0; j = 1/2, and c / k is what makes the ratio of both."""
    a, b, j = square(8.0), square(19.0), 0.5
    # k + c (1 + 1 / j) = a + b and k c / j = a b.
    half = 0.5 * (a + b)
    root = math.sqrt(half * half - (1 + 1 / j) * j * a * b)
    spring = half + root
    second = j * a * b / spring
    return (
        elastic("flex", LINK * spring, inertial(LINK), 8.0)
        + '<body name="fore">'
        + elastic("second", LINK * second, inertial(j * LINK), 19.0)
        + "</body>"
    )


def posed():
    stiffness = (LINK + LOAD * FAR**2) * square(FIRST)
    return (
        elastic("flex", stiffness, inertial(LINK), FIRST)
        + f'<body name="load"><joint name="slide" type="slide" axis="1 0 0"/>{inertial(1e-3, LOAD)}</body>'
    )


def distance(position):
    """Of the load, so that the frequency grows evenly from FIRST to LAST over RANGE."""
    hertz = FIRST + (LAST - FIRST) * position / RANGE
    inertia = (LINK + LOAD * FAR**2) * (FIRST / hertz) ** 2
    return math.sqrt(max(inertia - LINK, 0.0) / LOAD)


def model(arm):
    chain, slide = (two(), "") if arm == "two" else (posed(), SLIDE)
    kp, kv = MOTOR_INERTIA * SERVO**2, 1.6 * MOTOR_INERTIA * SERVO
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler angle="radian"/>
        <option timestep="{udp_arm.STEP / STEPS}" integrator="implicitfast" gravity="0 0 0"/>
        <worldbody><body name="motor">{inertial(MOTOR_INERTIA)}<joint name="motor" axis="0 0 1"/>
        <body name="link">{chain}</body></body></worldbody>
        <actuator><position name="position" joint="motor" kp="{kp}"/>
        <velocity name="velocity" joint="motor" kv="{kv}"/>{slide}</actuator></mujoco>"""
    )


SLIDE = f'<position name="slide" joint="slide" kp="{LOAD * SERVO**2}" kv="{1.6 * LOAD * SERVO}"/>'


class Arm:
    """What `udp_arm.Joint` asks of an arm."""

    def __init__(self, arm):
        self.model = model(arm)
        self.data = mujoco.MjData(self.model)
        self.has_load = arm != "two"
        self.omega = 2 * math.pi * FIRST
        if self.has_load:
            self.data.joint("slide").qpos = distance(0.0)

    def step(self, before, now):
        for k in range(STEPS):
            part = (k + 1) / STEPS
            self.data.actuator("position").ctrl = before[0] + part * (now[0] - before[0])
            self.data.actuator("velocity").ctrl = before[1] + part * (now[1] - before[1])
            if self.has_load:
                # The axis of the load goes with where the motor side is.
                self.data.actuator("slide").ctrl = distance(self.data.qpos[0])
            mujoco.mj_step(self.model, self.data)

    @property
    def state(self):
        u, y = self.data.qpos[0], self.data.qpos[0] + self.deformation
        return u, self.data.qvel[0], y, 0.0

    @property
    def deformation(self):
        return self.data.qpos[1] + (0.0 if self.has_load else self.data.qpos[2])


class Joint(udp_arm.Joint):
    """A joint whose arm is the engine's."""

    def __init__(self, name, options, chance):
        super().__init__(name, options, chance)
        self.arm, self.peak = Arm(options.arm), 0.0

    def watch(self, stamp, position, still):
        if not still:
            self.rest_since, self.ringing, self.peak = None, True, 0.0
            return
        if self.rest_since is None:
            self.rest_since = stamp
        since = stamp - self.rest_since - udp_arm.FOLLOWED
        if not self.ringing or since < 0.0:
            return
        self.peak = max(self.peak, abs(self.arm.deformation))
        if since > WATCHED:
            self.ringing = False
            if abs(position - self.rested_at) < udp_arm.LEAST_MOVE:
                return
            self.moves += 1
            told = {"joint": self.name, "move": self.moves, "from": self.rested_at}
            told |= {"to": position, "residual": self.peak}
            self.rested_at = position
            print(json.dumps(told), flush=True)


def main():
    at = sys.argv.index("--arm")
    arm = sys.argv[at + 1]
    del sys.argv[at : at + 2]
    options = udp_arm.options()
    options.arm = arm
    udp_arm.Joint = Joint
    udp_arm.Robot(options).run()


if __name__ == "__main__":
    main()

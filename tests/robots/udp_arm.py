#!/usr/bin/env python3
"""A flexible arm, of a joint or several, over UDP at 1 kHz, with a clock of its own, jitter, and loss
both ways.

It shares nothing with Quell but the datagrams. It plays setpoints back by their stamps, some
milliseconds late, as a robot controller with a jitter buffer does. Where in motion the next setpoint is missing
its time stands still for a while, so that it does not depend on who of the two is late. Its servo is of second order, its
link a mode that it knows. A machine that is busy makes it late and not wrong: it catches up step by
step, each datagram with the stamp of its own step. With --lockstep its time is that of the newest setpoint, so that what it does depends
on the setpoints alone, and on nobody's being late.

Orders come on stdin, one JSON object a line: {"frequency": 9.6}, {"silent": true},
{"fault": "stuck" | "jump" | "dead" | null}. After each move a line goes to stdout:
{"joint": "joint_1", "move": 1, "from": 0.0, "to": 0.5, "residual": 1e-4, "frequency": 8.0}; the residual is the true
amplitude of the deformation at the end of the command, rad. When stdin ends, every setpoint received
is written to --log and it ends.
"""

import argparse
import array
import bisect
import json
import math
import os
import random
import socket
import sys
import time

STEP = 0.001
# Age of a setpoint when it is played, s: more than a network and a late tick take.
DELAY = 0.010
# So long its time stands still for a setpoint that is missing, s: after that whoever commands is gone.
PATIENCE = 0.5
# A gap in the setpoints is bridged for so long, s; then the arm holds.
BRIDGED = 0.05
# The servo has followed its command to 1 in 1000 after so long, s.
FOLLOWED = 0.06
# What goes less far than this, rad, is a correction at rest and not a move.
LEAST_MOVE = 2e-3


class Arm:
    """Servo and mode, integrated by Runge and Kutta's fourth-order rule."""

    def __init__(self, frequency, damping, servo):
        self.omega, self.damping = 2 * math.pi * frequency, damping
        self.servo = 2 * math.pi * servo
        self.state = (0.0, 0.0, 0.0, 0.0)

    def slope(self, state, position, velocity):
        u, du, y, dy = state
        ws, w = self.servo, self.omega
        ddu = ws * ws * (position - u) + 2 * ws * (velocity - du)
        ddy = w * w * (u - y) + 2 * self.damping * w * (du - dy)
        return (du, ddu, dy, ddy)

    def step(self, before, now):
        (p0, v0), (p1, v1) = before, now
        pm, vm = 0.5 * (p0 + p1), 0.5 * (v0 + v1)
        moved = lambda k, h: tuple(x + h * d for x, d in zip(self.state, k))
        k1 = self.slope(self.state, p0, v0)
        k2 = self.slope(moved(k1, STEP / 2), pm, vm)
        k3 = self.slope(moved(k2, STEP / 2), pm, vm)
        k4 = self.slope(moved(k3, STEP), p1, v1)
        self.state = tuple(
            x + STEP / 6 * (a + 2 * b + 2 * c + d)
            for x, a, b, c, d in zip(self.state, k1, k2, k3, k4)
        )

    def amplitude(self, since):
        """Envelope of the deformation `since` s ago."""
        u, du, y, dy = self.state
        decay = self.damping * self.omega
        damped = self.omega * math.sqrt(1 - self.damping**2)
        d, v = y - u, dy - du
        return math.hypot(d, (v + decay * d) / damped) * math.exp(decay * since)


class Playback:
    """Setpoints by their stamps, on the arm's clock."""

    def __init__(self):
        self.times, self.points = [], []
        self.least, self.since = None, 0.0

    def take(self, arrived, stamp, position, velocity, acceleration):
        # The datagram of least delay tells how the clocks lie; both may drift by 100 ppm.
        way = arrived - stamp
        if self.times and stamp < self.times[-1] - 1.0:
            # Whoever commands has started anew, and its clock with it.
            self.times, self.points, self.least = [], [], None
        if self.least is not None:
            self.least += 1e-4 * (arrived - self.since)
        self.least = way if self.least is None else min(self.least, way)
        self.since = arrived
        at = bisect.bisect(self.times, stamp)
        self.times.insert(at, stamp)
        self.points.insert(at, (position, velocity, acceleration))
        if len(self.times) > 400:
            del self.times[:200], self.points[:200]

    def at(self, now):
        """Position and velocity to follow, and whether the command stands still."""
        if not self.times:
            return None
        stamp = now - self.least - DELAY
        k = bisect.bisect(self.times, stamp)
        if k == 0:
            p, _, _ = self.points[0]
            return (p, 0.0), True
        p, v, a = self.points[k - 1]
        if k == len(self.times):
            h = min(max(stamp - self.times[k - 1], 0.0), BRIDGED)
            return (p + v * h + a * h * h / 2, v + a * h), v == a == 0.0
        q, w, b = self.points[k]
        length = self.times[k] - self.times[k - 1]
        s = (stamp - self.times[k - 1]) / length
        # Cubic through both positions and velocities.
        position = (
            (1 + 2 * s) * (1 - s) ** 2 * p
            + s * (1 - s) ** 2 * length * v
            + s * s * (3 - 2 * s) * q
            + s * s * (s - 1) * length * w
        )
        return (position, v + s * (w - v)), v == a == w == b == 0.0


    def starves(self, now):
        """Whether in motion there is no setpoint to go on to."""
        if not self.times or now - self.least - DELAY <= self.times[-1]:
            return False
        _, v, a = self.points[-1]
        return v != 0.0 or a != 0.0


class Sensors:
    """What the arm says of itself."""

    def __init__(self, joint, options, chance):
        self.joint, self.options, self.chance = joint, options, chance
        self.fault, self.stuck = None, None
        cosine, sine = math.cos(0.7), math.sin(0.7)
        # The tracker stands somewhere, turned about two axes.
        self.frame = (
            (cosine, -sine * sine, sine * cosine),
            (0.0, cosine, sine),
            (-sine, -sine * cosine, cosine * cosine),
        )

    def read(self, step, stamp, u, y):
        noise = self.chance.gauss
        said = {"t": stamp, "joint": self.joint}
        said["motor_position"] = round(u / 1e-5) * 1e-5
        if step % self.options.divider:
            return said
        y += noise(0.0, self.options.noise)
        if self.fault == "jump" and self.chance.random() < 0.2:
            y += 0.3
        if self.fault == "stuck":
            y = self.stuck = self.stuck if self.stuck is not None else y
        else:
            self.stuck = None
        if self.fault == "dead":
            return said
        if self.options.sensor == "link":
            said["link_position"] = y
        elif self.options.sensor == "deformation":
            said["deformation"] = y if self.fault == "stuck" else y - u
        else:
            r = self.options.radius
            tip = (r * math.cos(y), r * math.sin(y), noise(0.0, self.options.noise))
            said["tip_position"] = [
                sum(row[k] * tip[k] for k in range(3)) + shift
                for row, shift in zip(self.frame, (1.2, -0.4, 0.9))
            ]
        return said


class Joint:
    """One joint: arm, playback and sensors."""

    def __init__(self, name, options, chance):
        self.name, self.options = name, options
        self.arm = Arm(options.frequency, options.damping, options.servo)
        self.playback, self.sensors = Playback(), Sensors(name, options, chance)
        self.command, self.moves = (0.0, 0.0), 0
        self.rest_since, self.rested_at, self.ringing = 0.0, 0.0, False

    def step(self, count, stamp):
        """What the sensors say after a step."""
        played = self.playback.at(stamp)
        if played:
            target, still = played
            self.arm.step(self.command, target)
            self.command = target
            self.watch(stamp, target[0], still)
        u, _, y, _ = self.arm.state
        return self.sensors.read(count, stamp, u, y)

    def watch(self, stamp, position, still):
        if not still:
            self.rest_since, self.ringing = None, True
        elif self.rest_since is None:
            self.rest_since = stamp
        elif self.ringing and stamp - self.rest_since > FOLLOWED:
            self.ringing = False
            if abs(position - self.rested_at) < LEAST_MOVE:
                return
            self.moves += 1
            told = {
                "joint": self.name,
                "move": self.moves,
                "from": self.rested_at,
                "to": position,
                "residual": self.arm.amplitude(stamp - self.rest_since),
                "frequency": self.arm.omega / (2 * math.pi),
            }
            self.rested_at = position
            print(json.dumps(told), flush=True)
            if self.moves == self.options.change_after:
                self.arm.omega *= self.options.change_by


class Robot:
    """Joints and network."""

    def __init__(self, options):
        self.options = options
        self.chance = random.Random(options.seed)
        names = [f"joint_{k + 1}" for k in range(options.joints)]
        self.joints = {name: Joint(name, options, self.chance) for name in names}
        host, port = options.service.rsplit(":", 1)
        self.service = (host, int(port))
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.socket.setblocking(False)
        self.log = array.array("d")
        self.held, self.silent = [], False
        # Newest stamp of a setpoint, and its own time then.
        self.newest, self.offset = None, 0.0

    def hear(self, clock):
        while True:
            try:
                bytes_, _ = self.socket.recvfrom(2048)
            except (BlockingIOError, ConnectionRefusedError):
                return
            said = json.loads(bytes_)
            point = [said[k] for k in ("position", "velocity", "acceleration")]
            if self.options.log:
                number = int(said["joint"].rsplit("_", 1)[1])
                self.log.extend([number, said["seq"], said["t"], *point])
            if self.options.lockstep:
                if self.newest is None:
                    self.newest, self.offset = said["t"], clock - said["t"]
                self.newest = max(self.newest, said["t"])
                clock = said["t"] + self.offset
            if self.chance.random() >= self.options.loss:
                self.joints[said["joint"]].playback.take(clock, said["t"], *point)

    def step(self, count, stamp):
        for joint in self.joints.values():
            self.say(json.dumps(joint.step(count, stamp)).encode())

    def say(self, datagram):
        chance = self.chance.random()
        if self.silent or chance < self.options.loss:
            return
        if chance < self.options.loss + 0.01:
            # It takes a longer way and comes after a younger one.
            self.held.append(datagram)
            return
        self.send(datagram)
        if chance > 0.995:
            self.send(datagram)
        while self.held:
            self.send(self.held.pop())

    def send(self, datagram):
        try:
            self.socket.sendto(datagram, self.service)
        except (BlockingIOError, ConnectionRefusedError):
            pass

    def obey(self, line):
        order = json.loads(line)
        if "frequency" in order:
            for joint in self.joints.values():
                joint.arm.omega = 2 * math.pi * order["frequency"]
        if "silent" in order:
            self.silent = order["silent"]
        if "fault" in order:
            for joint in self.joints.values():
                joint.sensors.fault = order["fault"]

    def run(self):
        os.set_blocking(sys.stdin.fileno(), False)
        rest, count, started = b"", 0, time.monotonic()
        # Its clock was started another day.
        own = lambda: 86_412.5 + (time.monotonic() - started) * (1 + self.options.skew)
        stepped = lambda: self.options.lockstep and self.newest is not None
        clock = lambda: self.newest + self.offset if stepped() else own()
        next_step = fed = clock()
        while True:
            self.hear(clock())
            while next_step <= clock():
                starves = any(joint.playback.starves(next_step) for joint in self.joints.values())
                if starves and clock() - fed < PATIENCE:
                    break
                fed = fed if starves else clock()
                self.step(count, next_step)
                count, next_step = count + 1, next_step + STEP
                if count % 16 == 0:
                    break
            # Where its time stands still its orders come nevertheless.
            if count % 16 == 0 or stepped():
                try:
                    read = os.read(sys.stdin.fileno(), 4096)
                except BlockingIOError:
                    read = None
                if read == b"":
                    return
                *lines, rest = (rest + (read or b"")).split(b"\n")
                for line in lines:
                    self.obey(line)
            wait = next_step - clock() + self.chance.uniform(0.0, self.options.jitter)
            # Where it starves the next step is over due.
            time.sleep(max(0.0 if stepped() else wait, 2e-4))


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--service", required=True, help="host:port of the UDP link")
    parser.add_argument("--joints", type=int, default=1, help="joint_1 to joint_<number>")
    parser.add_argument("--sensor", default="link", choices=["link", "tip", "deformation"])
    parser.add_argument("--divider", type=int, default=1, help="steps a sample of that sensor")
    parser.add_argument("--frequency", type=float, default=8.0, help="Hz")
    parser.add_argument("--damping", type=float, default=0.05)
    parser.add_argument("--servo", type=float, default=30.0, help="Hz")
    parser.add_argument("--radius", type=float, default=0.8, help="of the tip, m")
    parser.add_argument("--noise", type=float, default=5e-6, help="rad or m, standard deviation")
    parser.add_argument("--loss", type=float, default=0.02, help="share, each way")
    parser.add_argument("--jitter", type=float, default=5e-4, help="s, of when it wakes up")
    parser.add_argument("--skew", type=float, default=5e-5, help="of its clock")
    parser.add_argument("--lockstep", action="store_true", help="its time is that of the setpoints")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--change-after", type=int, default=0, help="moves")
    parser.add_argument("--change-by", type=float, default=1.2)
    parser.add_argument("--log", help="file for every setpoint received: CSV")
    return parser.parse_args()


def main():
    robot = Robot(options())
    robot.run()
    if robot.options.log:
        with open(robot.options.log, "w") as file:
            file.write("joint,seq,t,position,velocity,acceleration\n")
            for k in range(0, len(robot.log), 6):
                joint, seq, *numbers = robot.log[k : k + 6]
                file.write(f"{int(joint)},{int(seq)}," + ",".join(map(repr, numbers)) + "\n")


if __name__ == "__main__":
    main()

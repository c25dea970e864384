"""A robot that speaks ROS 2 over Zenoh, and somebody who moves it, once there is the file ENABLED: robot.py PORT ENABLED.

The robot is of eclipse-zenoh and rosbags alone: it takes the positions that are commanded, one step for each message,
and answers with joint states of motor and link; the link rings in one mode. Type hashes are computed from the
definitions that rosbags has. Whoever moves it is zenoh-ros2-sdk: it sends trajectories and hears modes and impulses.
Prints as JSON what was seen.
"""

import json
import math
import os
import struct
import sys
import threading
import time

import numpy as np
import zenoh
from rosbags.typesys import Stores, get_typestore
from zenoh_ros2_sdk import ROS2Publisher, ROS2Subscriber

RATE, FREQUENCY, DAMPING = 250.0, 6.9, 0.05
START, TARGETS = 0.3, (0.9, 0.1, 0.9)
PATIENCE = 40.0

types = get_typestore(Stores.ROS2_JAZZY)
kinds = types.types
Time, Header = kinds["builtin_interfaces/msg/Time"], kinds["std_msgs/msg/Header"]
JointState = kinds["sensor_msgs/msg/JointState"]
ARRAY, TRAJECTORY = "std_msgs/msg/Float64MultiArray", "trajectory_msgs/msg/JointTrajectory"


def key(topic, kind):
    package, _, name = kind.split("/")
    return f"0{topic}/{package}::msg::dds_::{name}_/{types.hash_rihs01(kind)}"


class Robot:
    """A motor side that goes where it is told, and a link on a damped spring behind it."""

    def __init__(self, session):
        self.motor, self.link = (
            session.declare_publisher(key(topic, "sensor_msgs/msg/JointState"))
            for topic in ("/joint_states", "/link_states")
        )
        self.steps, self.sent, self.state = 0, [START] * 3, np.zeros(2)
        self.commands, self.attachments = [], []
        omega, decay = 2 * math.pi * FREQUENCY, 2 * math.pi * FREQUENCY * DAMPING
        damped, dt = omega * math.sqrt(1 - DAMPING**2), 1 / RATE
        c, s, e = math.cos(damped * dt), math.sin(damped * dt), math.exp(-decay * dt)
        self.step = e * np.array(
            [[c + decay / damped * s, s / damped], [-(omega**2) / damped * s, c - decay / damped * s]]
        )
        self.lock = threading.Lock()
        self.ears = session.declare_subscriber(key("/forward_position_controller/commands", ARRAY), self.obey)

    def obey(self, sample):
        array = types.deserialize_cdr(sample.payload.to_bytes(), ARRAY)
        with self.lock:
            self.commands.append(float(array.data[0]))
            self.labels = [(dim.label, dim.size, dim.stride) for dim in array.layout.dim]
            self.attachments.append(sample.attachment.to_bytes())
            self.move(self.commands[-1])
        self.tell()

    def move(self, position):
        self.sent = [*self.sent[1:], position]
        before, middle, now = self.sent
        # The motor side goes straight from one position to the next: its velocity jumps, the link's does not.
        self.state = self.step @ (self.state - [0.0, (now - 2 * middle + before) * RATE])
        self.steps += 1

    def tell(self):
        # A clock of its own: a minute ahead.
        stamp = time_zero + 60 * 10**9 + round(self.steps * 1e9 / RATE)
        header = Header(stamp=Time(sec=stamp // 10**9, nanosec=stamp % 10**9), frame_id="")
        for publisher, position in ((self.motor, self.sent[-1]), (self.link, self.sent[-1] + self.state[0])):
            none = np.zeros(0)
            # Of a gripper nobody asked.
            names, positions = ["gripper", "joint_1"], np.array([0.04, position])
            state = JointState(header=header, name=names, position=positions, velocity=none, effort=none)
            publisher.put(bytes(types.serialize_cdr(state, "sensor_msgs/msg/JointState")))


def wait(what, holds):
    end = time.monotonic() + PATIENCE
    while not holds():
        if time.monotonic() > end:
            # Threads of Zenoh's would go on.
            print(f"waited for {what} in vain", file=sys.stderr, flush=True)
            os._exit(1)
        time.sleep(0.02)


def rests_at(robot, target):
    with robot.lock:
        last = robot.commands[-int(1.5 * RATE) :]
    return len(last) > RATE and all(abs(position - target) < 1e-9 for position in last)


def peer(of, kind, topic, *more):
    text, digest = types.generate_msgdef(kind, ros_version=2)[0], types.hash_rihs01(kind)
    return of(topic, kind, *more, msg_definition=text, type_hash=digest, router_port=port, domain_id=0)


def trajectory(positions, names=("joint_1",)):
    """With a first point that is not the target."""
    now = Header(stamp=Time(sec=0, nanosec=0), frame_id="")
    none, kind = np.zeros(0), kinds["trajectory_msgs/msg/JointTrajectoryPoint"]
    later = kinds["builtin_interfaces/msg/Duration"](sec=1, nanosec=0)
    points = [
        kind(positions=np.array(p), velocities=none, accelerations=none, effort=none, time_from_start=later)
        for p in ([0.5] * len(positions), positions)
    ]
    mover.publish(header=now, joint_names=list(names), points=points)


port = int(sys.argv[1])
config = zenoh.Config()
for name, value in (
    ("mode", '"peer"'),
    ("connect/endpoints", f'["tcp/127.0.0.1:{port}"]'),
    ("listen/endpoints", "[]"),
    ("scouting/multicast/enabled", "false"),
):
    config.insert_json5(name, value)
session = zenoh.open(config)
time_zero = time.time_ns()

tokens = []


def announced():
    tokens[:] = sorted(str(reply.ok.key_expr) for reply in session.liveliness().get("@ros2_lv/0/**") if reply.ok)
    return sum("/quell/" in token or token.endswith("/quell") for token in tokens) >= 8


wait("the tokens of liveliness", announced)
robot = Robot(session)
modes, impulses = [], []
mover = peer(ROS2Publisher, TRAJECTORY, "/joint_trajectory_controller/joint_trajectory")
ears = [
    peer(ROS2Subscriber, ARRAY, "/quell/joint_1/mode", modes.append),
    peer(ROS2Subscriber, ARRAY, "/quell/joint_1/impulses", impulses.append),
]


end = time.monotonic() + PATIENCE
while not robot.commands and time.monotonic() < end:
    time.sleep(1 / RATE)
    robot.steps += 1
    robot.tell()
wait("modes and impulses", lambda: modes and impulses)
wait("moves to be enabled", lambda: os.path.exists(sys.argv[2]))
garbage = session.declare_publisher(key("/joint_states", "sensor_msgs/msg/JointState"))
for length in range(20):
    garbage.put(bytes([0, 1, 0, 0] + [255] * length))
trajectory([1.0], ["elbow"])
trajectory([math.nan])
trajectory([0.2, 0.3])
for target in TARGETS:
    trajectory([target])
    wait(f"the end of the move to {target}", lambda: rests_at(robot, target))


def array(message):
    return {
        "dimensions": [[dim.label, int(dim.size), int(dim.stride)] for dim in message.layout.dim],
        "data": [None if math.isnan(number) else float(number) for number in message.data],
    }


with robot.lock:
    told = [struct.unpack("<qqB16s", attachment) for attachment in robot.attachments]
    json.dump(
        {
            "tokens": tokens,
            "frequency_hz": FREQUENCY,
            "labels": robot.labels,
            "commands": robot.commands,
            "numbers": [number for number, _, _, _ in told],
            "age_s": max(abs(sent - time.time_ns()) for _, sent, _, _ in told) * 1e-9,
            "senders": sorted({sender.hex() for _, _, _, sender in told}),
            "mode": array(modes[-1]),
            "impulses": array(impulses[-1]),
        },
        sys.stdout,
    )
sys.stdout.flush()
# Threads of Zenoh's would go on.
os._exit(0)

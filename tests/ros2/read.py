"""Reads every message of an MCAP file with rosbags and with mcap-ros2-support, and prints both as JSON.

Of each message: topic, log time, publish time (0 where the package does not tell), stamp of the header (null where
there is none), names, numbers in the order of the definition. A number is printed as the integer that its eight bytes
are, so that it can be compared to the bit.
"""

import json
import struct
import sys
from pathlib import Path

from mcap_ros2.reader import read_ros2_messages
from rosbags.highlevel import AnyReader


def numbers(message):
    kept = []
    for field in ("position", "velocity", "effort", "point", "vector", "data"):
        value = getattr(message, field, None)
        if value is None:
            continue
        if hasattr(value, "x"):
            kept += [value.x, value.y, value.z]
        elif hasattr(value, "__len__"):
            kept += [float(number) for number in value]
        else:
            kept.append(float(value))
    return [struct.unpack("<q", struct.pack("<d", number))[0] for number in kept]


def row(topic, logged, published, message):
    header = getattr(message, "header", None)
    stamp = header.stamp.sec * 10**9 + header.stamp.nanosec if header else None
    return [topic, logged, published, stamp, list(getattr(message, "name", [])), numbers(message)]


def by_rosbags(path):
    with AnyReader([path]) as reader:
        for connection, logged, raw in reader.messages():
            yield row(connection.topic, logged, 0, reader.deserialize(raw, connection.msgtype))


def by_mcap(path):
    for m in read_ros2_messages(str(path)):
        published = int(m.publish_time_ns)
        yield row(m.channel.topic, int(m.log_time_ns), published, m.ros_msg)


path = Path(sys.argv[1])
json.dump({"rosbags": list(by_rosbags(path)), "mcap": list(by_mcap(path))}, sys.stdout)

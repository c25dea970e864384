"""Writes a recording with mcap-ros2-support, once with each compression: none.mcap, lz4.mcap, zstd.mcap.

At k / 100 s, k from 0 to 499: a sensor_msgs/Imu, a std_msgs/Float64MultiArray, and a type of its own with what
definitions can have: constants, defaults, bounds, arrays, sequences of records, numbers of all sizes.

And states.mcap: the joint states of an arm, and those of its links under another topic.
"""

import sys
from pathlib import Path

from mcap.writer import CompressionType
from mcap_ros2.writer import Writer

LINE = "=" * 80 + "\n"
TIME = LINE + "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
HEADER = LINE + "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + TIME
IMU = """# An inertial measurement unit.
std_msgs/Header header
geometry_msgs/Quaternion orientation
float64[9] orientation_covariance # row major
geometry_msgs/Vector3 angular_velocity
float64[9] angular_velocity_covariance
geometry_msgs/Vector3 linear_acceleration
float64[9] linear_acceleration_covariance
""" + LINE + """MSG: geometry_msgs/Quaternion
float64 x 0
float64 y 0
float64 z 0
float64 w 1
""" + LINE + "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" + HEADER
ARRAY = """MultiArrayLayout layout
float64[] data
""" + LINE + "MSG: std_msgs/MultiArrayLayout\nMultiArrayDimension[] dim\nuint32 data_offset\n" + LINE + \
    "MSG: std_msgs/MultiArrayDimension\nstring label\nuint32 size\nuint32 stride\n"
ARM = """# Constants are no fields.
uint8 MODE_IDLE=0
uint8 MODE_MOVE = 1
string GREETING="a = b"
bool ready
std_msgs/Header header
string<=16 label
uint8[] blob
int8 small
Axis[] axes
uint16 mode 1
float32 gain 1.5
uint64[<=4] counters
float64[3] tip
string[] joint_names
float32[] angles
""" + LINE + "MSG: arm_msgs/Axis\nstring name\nint16 counts\nfloat32 angle\n" + HEADER

STATE = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n" + HEADER


def main(folder):
    for compression in (CompressionType.NONE, CompressionType.LZ4, CompressionType.ZSTD):
        with open(folder / f"{compression.name.lower()}.mcap", "wb") as stream:
            writer = Writer(stream, chunk_size=8192, compression=compression)
            write(writer)
            writer.finish()
    with open(folder / "states.mcap", "wb") as stream:
        writer = Writer(stream)
        state = writer.register_msgdef("sensor_msgs/msg/JointState", STATE)
        for k in range(500):
            stamp = {"sec": 1_700_000_000 + k // 100, "nanosec": 10_000_000 * (k % 100)}
            for topic, more in (("/joint_states", 0.0), ("/link_states", 0.25)):
                message = {
                    "header": {"stamp": stamp, "frame_id": ""}, "name": ["hip", "knee"],
                    "position": [k / 16 + more, -k / 16 + more], "velocity": [], "effort": [],
                }
                writer.write_message(topic, state, message, 1_700_000_000_000_000_000 + 10_000_000 * k)
        writer.finish()


def write(writer):
    imu = writer.register_msgdef("sensor_msgs/msg/Imu", IMU)
    array = writer.register_msgdef("std_msgs/msg/Float64MultiArray", ARRAY)
    arm = writer.register_msgdef("arm_msgs/msg/Arm", ARM)
    for k in range(500):
        # The log is 3 ms behind the stamp.
        logged = 1_700_000_000_000_000_000 + 10_000_000 * k + 3_000_000
        stamp = {"sec": 1_700_000_000 + k // 100, "nanosec": 10_000_000 * (k % 100)}
        header = {"stamp": stamp, "frame_id": "x" * (k % 7)}
        quaternion = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
        vectors = {"angular_velocity": xyz(k), "linear_acceleration": xyz(k + 0.5)}
        covariances = {f"{name}_covariance": [0.0] * 9 for name in ("orientation", *vectors)}
        writer.write_message("/imu", imu, {"header": header, "orientation": quaternion} | vectors | covariances, logged)
        dim = [{"label": "joints", "size": 2, "stride": 2}]
        layout = {"dim": dim, "data_offset": 0}
        writer.write_message("/array", array, {"layout": layout, "data": [k / 8, -k / 8]}, logged)
        axes = [{"name": f"axis_{i}", "counts": i - k, "angle": (k + i) / 4} for i in range(3)]
        message = {
            "ready": k % 2 == 0, "header": header, "label": "arm"[: k % 4], "blob": bytes(k % 5), "small": -3,
            "axes": axes, "mode": 1, "gain": 0.25, "counters": [k, 2**40 + k], "tip": [k / 2, k / 4, -k / 8],
            "joint_names": ["hip", "knee"] if k % 3 else ["knee", "hip"],
            "angles": [k / 16, -k / 16] if k % 3 else [-k / 16, k / 16],
        }
        writer.write_message("/arm", arm, message, logged)


def xyz(value):
    return {"x": value, "y": -value, "z": 2.0 * value}


main(Path(sys.argv[1]))

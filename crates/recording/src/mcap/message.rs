//! The written messages: their ROS 2 definitions and their CDR bodies.

use super::cdr::Encoder;

/// A message type with the definitions of its parts.
#[derive(Debug)]
pub(super) struct Definition {
    pub name: &'static str,
    pub text: &'static str,
}

macro_rules! with_header {
    ($fields:literal) => {
        concat!(
            "std_msgs/Header header\n",
            $fields,
            "================================================================================\n\
             MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
             ================================================================================\n\
             MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
        )
    };
}

pub(super) const JOINT_STATE: Definition = Definition {
    name: "sensor_msgs/msg/JointState",
    text: with_header!("string[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n"),
};

pub(super) const POINT_STAMPED: Definition = Definition {
    name: "geometry_msgs/msg/PointStamped",
    text: with_header!(
        "geometry_msgs/Point point\n\
         ================================================================================\n\
         MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n"
    ),
};

pub(super) const VECTOR_STAMPED: Definition = Definition {
    name: "geometry_msgs/msg/Vector3Stamped",
    text: with_header!(
        "geometry_msgs/Vector3 vector\n\
         ================================================================================\n\
         MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
    ),
};

pub(super) const FLOAT: Definition = Definition {
    name: "std_msgs/msg/Float64",
    text: "float64 data\n",
};

pub(super) const FLOATS: Definition = Definition {
    name: "std_msgs/msg/Float64MultiArray",
    text: "std_msgs/MultiArrayLayout layout\nfloat64[] data\n\
           ================================================================================\n\
           MSG: std_msgs/MultiArrayLayout\nstd_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n\
           ================================================================================\n\
           MSG: std_msgs/MultiArrayDimension\nstring label\nuint32 size\nuint32 stride\n",
};

/// `sensor_msgs/msg/JointState` of one joint; unmeasured quantities are empty.
pub(super) struct JointState<'a> {
    pub name: &'a str,
    pub position: &'a [f64],
    pub velocity: &'a [f64],
    pub effort: &'a [f64],
}

impl JointState<'_> {
    pub(super) fn encode(&self, stamp: i64, out: &mut Encoder) {
        header(stamp, "", out);
        out.u32(1);
        out.string(self.name);
        for values in [self.position, self.velocity, self.effort] {
            out.f64s(values);
        }
    }
}

/// `geometry_msgs/msg/PointStamped` and `Vector3Stamped`, which have the same layout.
pub(super) fn encode_vector(stamp: i64, frame: &str, vector: [f64; 3], out: &mut Encoder) {
    header(stamp, frame, out);
    vector.iter().for_each(|value| out.f64(*value));
}

/// `std_msgs/msg/Float64`.
pub(super) fn encode_float(value: f64, out: &mut Encoder) {
    out.clear();
    out.f64(value);
}

/// Begins a message with `std_msgs/msg/Header`; the stamp in ns, from 1970 to 2038.
fn header(stamp: i64, frame: &str, out: &mut Encoder) {
    const SECOND: i64 = 1_000_000_000;
    out.clear();
    out.i32((stamp / SECOND) as i32);
    out.u32((stamp % SECOND) as u32);
    out.string(frame);
}

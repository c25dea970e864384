//! The ROS 2 messages of the link: names, type hashes, CDR bodies.

use crate::recording::Decoder;
use crate::service::link::datagram::usual;

const SECOND: i64 = 1_000_000_000;
/// Most points and names of a message; a larger one is no planned trajectory.
const MOST: usize = 100_000;

/// A message type in a key expression.
///
/// The hash is that of the definition, so that peers with another one are ignored.
/// Source: ROS 2 REP 2016, "RIHS01".
pub(super) struct MessageType {
    pub name: &'static str,
    pub hash: &'static str,
}

pub(super) const JOINT_STATE: MessageType = MessageType {
    name: "sensor_msgs::msg::dds_::JointState_",
    hash: "RIHS01_a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
};

pub(super) const IMU: MessageType = MessageType {
    name: "sensor_msgs::msg::dds_::Imu_",
    hash: "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
};

pub(super) const JOINT_TRAJECTORY: MessageType = MessageType {
    name: "trajectory_msgs::msg::dds_::JointTrajectory_",
    hash: "RIHS01_179b33eba59d676f6d967ac71fe35e7ca2f64b2f3928f4a018cec115e213796e",
};

pub(super) const FLOAT64_MULTI_ARRAY: MessageType = MessageType {
    name: "std_msgs::msg::dds_::Float64MultiArray_",
    hash: "RIHS01_1025ddc6b9552d191f89ef1a8d2f60f3d373e28b283d8891ddcc974e8c55397f",
};

/// The used fields of `sensor_msgs/msg/JointState`.
#[derive(Debug, PartialEq)]
pub(super) struct JointState<'a> {
    /// Stamp, ns since 1970; 0 where the sender does not set it.
    pub stamp: i64,
    /// Names and positions, rad; NaN where there is no reading.
    pub positions: Vec<(&'a str, f64)>,
}

/// The used fields of `sensor_msgs/msg/Imu`.
#[derive(Debug, PartialEq)]
pub(super) struct Imu {
    /// Stamp, ns since 1970; 0 where the sender does not set it.
    pub stamp: i64,
    /// Linear acceleration, m/s^2; NaN where there is no reading.
    pub acceleration: [f64; 3],
}

/// Reads `sensor_msgs/msg/JointState`; `None` where the bytes are malformed. A message without positions is
/// valid and empty.
pub(super) fn joint_state(bytes: &[u8]) -> Option<JointState<'_>> {
    let mut from = Decoder::new(bytes).ok()?;
    let stamp = header(&mut from)?;
    let names = strings(&mut from)?;
    let positions = numbers(&mut from)?;
    let fits = positions.is_empty() || positions.len() == names.len();
    fits.then(|| JointState {
        stamp,
        positions: names
            .into_iter()
            .zip(positions.into_iter().map(usual))
            .collect(),
    })
}

/// Reads `sensor_msgs/msg/Imu`; `None` where the bytes are malformed, or the acceleration is not measured, as a
/// first covariance of -1 tells.
pub(super) fn imu(bytes: &[u8]) -> Option<Imu> {
    let mut from = Decoder::new(bytes).ok()?;
    let stamp = header(&mut from)?;
    // Orientation and its covariance, angular velocity and its covariance.
    for _ in 0..4 + 9 + 3 + 9 {
        number(&mut from)?;
    }
    let mut acceleration = [0.0; 3];
    for value in &mut acceleration {
        *value = number(&mut from)?;
    }
    let measured = number(&mut from)? != -1.0;
    measured.then(|| Imu {
        stamp,
        acceleration: acceleration.map(usual),
    })
}

/// Reads the last point of `trajectory_msgs/msg/JointTrajectory`: names and positions, rad. `None` where the
/// bytes are malformed, or the point lacks the position of a joint.
pub(super) fn targets(bytes: &[u8]) -> Option<Vec<(String, f64)>> {
    let mut from = Decoder::new(bytes).ok()?;
    header(&mut from)?;
    let names = strings(&mut from)?;
    let points = length(&mut from)?;
    let mut last = Vec::new();
    for _ in 0..points {
        last = numbers(&mut from)?;
        // Velocities, accelerations, effort.
        for _ in 0..3 {
            numbers(&mut from)?;
        }
        time(&mut from)?;
    }
    let names = names.into_iter().map(str::to_owned);
    (names.len() == last.len() && points > 0).then(|| names.zip(last).collect())
}

/// `std_msgs/msg/Header`: its stamp in ns.
fn header(from: &mut Decoder) -> Option<i64> {
    let stamp = time(from)?;
    from.string().ok()?;
    Some(stamp)
}

/// `builtin_interfaces/msg/Time` or `Duration`, ns.
fn time(from: &mut Decoder) -> Option<i64> {
    let seconds = i32::from_le_bytes(from.number().ok()?);
    let rest = u32::from_le_bytes(from.number().ok()?);
    Some(i64::from(seconds) * SECOND + i64::from(rest))
}

fn length(from: &mut Decoder) -> Option<usize> {
    from.length().ok().filter(|length| *length <= MOST)
}

fn number(from: &mut Decoder) -> Option<f64> {
    Some(f64::from_le_bytes(from.number().ok()?))
}

fn numbers(from: &mut Decoder) -> Option<Vec<f64>> {
    (0..length(from)?).map(|_| number(from)).collect()
}

fn strings<'a>(from: &mut Decoder<'a>) -> Option<Vec<&'a str>> {
    (0..length(from)?).map(|_| from.string().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Encoder;

    /// A trajectory of two joints and two points.
    fn trajectory() -> Vec<u8> {
        let mut out = Encoder::new();
        out.i32(1);
        out.u32(5);
        out.string("base");
        out.u32(2);
        out.string("hip");
        out.string("knee");
        out.u32(2);
        for end in [[0.1, 0.2], [0.3, -0.4]] {
            out.f64s(&end);
            out.f64s(&[1.0, 1.0]);
            out.f64s(&[]);
            out.f64s(&[]);
            out.i32(2);
            out.u32(0);
        }
        out.bytes().to_vec()
    }

    #[test]
    fn the_last_point_is_the_target() {
        let targets = targets(&trajectory());
        assert_eq!(
            targets,
            Some(vec![("hip".into(), 0.3), ("knee".into(), -0.4)])
        );
    }

    #[test]
    fn a_joint_without_a_reading_leaves_those_of_the_others() {
        let mut out = Encoder::new();
        out.i32(1);
        out.u32(5);
        out.string("base");
        out.u32(2);
        out.string("hip");
        out.string("knee");
        out.f64s(&[f64::INFINITY, -0.4]);
        let read = joint_state(out.bytes()).expect("a message");
        assert_eq!(read.positions[1], ("knee", -0.4));
        assert!(read.positions[0].1.is_nan());
    }

    #[test]
    fn a_damaged_message_is_none() {
        let whole = trajectory();
        for length in 0..whole.len() {
            assert_eq!(targets(&whole[..length]), None, "cut at {length}");
        }
        // Whatever a byte becomes, nothing panics, and no length takes more than there is.
        for at in 0..whole.len() {
            for value in [0, 1, 0x7f, 0x80, 0xff] {
                let mut damaged = whole.clone();
                damaged[at] = value;
                let _ = (targets(&damaged), joint_state(&damaged), imu(&damaged));
            }
        }
    }
}

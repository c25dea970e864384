//! One JSON object a datagram, SI units.

use std::io::{Cursor, Write};

use quell_shapers::Setpoint;
use serde::Deserialize;

use crate::service::contract::Quantity;

/// The longest datagram that is read, bytes; a longer one is malformed.
pub const LONGEST: usize = 2048;
/// The largest magnitude of a value: larger than any joint position, stamp or length of a robot, and its square
/// is finite.
pub(super) const LARGEST: f64 = 1e12;

/// Robot to service: `{"t": 12.345, "joint": "joint_1", "motor_position": 0.1, "link_position": 0.1}`.
///
/// Other keys of the object are ignored.
#[derive(Clone, Debug, Deserialize)]
pub struct FromRobot<'a> {
    /// Stamp on the robot's clock, s.
    pub t: f64,
    /// Number of the datagram, of any joint; needed where datagrams are signed.
    pub seq: Option<u64>,
    /// Name of the joint.
    #[serde(borrow)]
    pub joint: std::borrow::Cow<'a, str>,
    /// Motor-side position, rad.
    pub motor_position: Option<f64>,
    /// Link position, rad.
    pub link_position: Option<f64>,
    /// Link minus motor, rad.
    pub deformation: Option<f64>,
    /// Tip in the sensor's own frame, m.
    pub tip_position: Option<[f64; 3]>,
    /// Acceleration of the tip in the sensor's own frame, m/s^2.
    pub tip_acceleration: Option<[f64; 3]>,
}

impl<'a> FromRobot<'a> {
    /// Reads a datagram; `None` where it is malformed, or contains an impossible value.
    ///
    /// # Example
    /// ```
    /// use quell::service::link::datagram::FromRobot;
    /// let datagram = br#"{"t": 0.1, "joint": "joint_1", "deformation": 1e-3}"#;
    /// assert_eq!(FromRobot::parse(datagram).and_then(|read| read.deformation), Some(1e-3));
    /// let nameless = br#"[0.1, null, "joint_1", null, null, 1e-3, null, null]"#;
    /// assert!(FromRobot::parse(nameless).is_none());
    /// ```
    pub fn parse(bytes: &'a [u8]) -> Option<Self> {
        // Serde accepts an array for an object's values in their order, which does not name the quantities.
        if bytes.trim_ascii_start().starts_with(b"[") {
            return None;
        }
        let datagram: Self = serde_json::from_slice(bytes).ok()?;
        let usual = |value: &f64| value.abs() <= LARGEST;
        let mut quantities = datagram.quantities().peekable();
        let something = quantities.peek().is_some();
        let all = quantities.all(|(_, value)| value.iter().all(usual));
        (something && all && usual(&datagram.t)).then_some(datagram)
    }

    /// Its values; a scalar is the first component.
    pub fn quantities(&self) -> impl Iterator<Item = (Quantity, [f64; 3])> + use<'a> {
        let scalar = |value: Option<f64>| value.map(|value| [value, 0.0, 0.0]);
        [
            (Quantity::MotorPosition, scalar(self.motor_position)),
            (Quantity::LinkPosition, scalar(self.link_position)),
            (Quantity::Deformation, scalar(self.deformation)),
            (Quantity::TipPosition, self.tip_position),
            (Quantity::TipAcceleration, self.tip_acceleration),
        ]
        .into_iter()
        .filter_map(|(quantity, value)| Some((quantity, value?)))
    }
}

/// Service to robot, each tick: `{"seq": 7, "t": 12.348, "joint": "joint_1", "position": .., "velocity": ..,
/// "acceleration": ..}`. It is written into `buffer`, whose filled part is returned; `t` is on the service's
/// clock. No allocation.
///
/// `joint` is a name that needs no escapes. `None` where the buffer is too short.
pub fn write_setpoint<'b>(
    buffer: &'b mut [u8],
    sequence: u64,
    time: f64,
    joint: &str,
    setpoint: &Setpoint,
) -> Option<&'b [u8]> {
    let mut cursor = Cursor::new(&mut *buffer);
    let Setpoint {
        position,
        velocity,
        acceleration,
    } = setpoint;
    write!(
        cursor,
        "{{\"seq\":{sequence},\"t\":{time:.9},\"joint\":\"{joint}\",\"position\":{position:e},\
         \"velocity\":{velocity:e},\"acceleration\":{acceleration:e}}}"
    )
    .ok()?;
    let length = cursor.position() as usize;
    buffer.get(..length)
}

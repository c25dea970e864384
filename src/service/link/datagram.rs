//! One JSON object a datagram, SI units.

use std::io::{Cursor, Write};

use quell_shapers::Setpoint;
use serde::Deserialize;

use crate::service::contract::Quantity;

/// The longest datagram that is read, bytes; a longer one is malformed.
pub const LONGEST: usize = 2048;
/// The largest magnitude of a value: larger than any joint position, stamp or length of a robot, and its square
/// is finite.
const LARGEST: f64 = 1e12;
/// A number of JSON above [`LARGEST`].
const NO_READING: &[u8] = b"9e99";

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
    /// Reads a datagram; `None` where it is malformed: its stamp is no number within 1e12, or there is no reading.
    ///
    /// A reading that is no number, as `NaN`, `nan`, `-Infinity` or `1e999`, is not JSON; it is read for all that, so
    /// that a sensor without a reading does not take those of the others with it.
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
        let datagram: Self = match serde_json::from_slice(bytes) {
            Ok(datagram) => datagram,
            Err(_) => Self::with_what_is_no_number(bytes)?,
        };
        let something = datagram.quantities().next().is_some();
        (something && is_usual(datagram.t)).then_some(datagram)
    }

    /// Reads a datagram in which numbers are not finite.
    fn with_what_is_no_number(bytes: &[u8]) -> Option<Self> {
        let json = numbers_finite(bytes)?;
        let datagram: FromRobot<'_> = serde_json::from_slice(&json).ok()?;
        Some(Self {
            joint: datagram.joint.into_owned().into(),
            ..datagram
        })
    }

    /// Its values; a scalar is the first component. A component that is not finite, or beyond 1e12, is NaN.
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
        .filter_map(|(quantity, value)| Some((quantity, value?.map(usual))))
    }
}

/// The value; NaN where it is impossible.
pub(super) fn usual(value: f64) -> f64 {
    if is_usual(value) { value } else { f64::NAN }
}

fn is_usual(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// JSON in which [`NO_READING`] stands for each number that is not finite; `None` where there is none.
fn numbers_finite(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut json = Vec::with_capacity(bytes.len() + 16);
    let (mut rest, mut found) = (bytes, false);
    while let Some(&first) = rest.first() {
        let (length, is_value) = match first {
            b'"' => (text_length(rest), false),
            _ if ends_value(first) => (1, false),
            _ => (length_until(rest, ends_value), true),
        };
        let (token, after) = rest.split_at(length);
        let value = std::str::from_utf8(token).ok().filter(|_| is_value);
        let number = value.and_then(|value| value.parse::<f64>().ok());
        let no_reading = number.is_some_and(|number| !number.is_finite());
        json.extend_from_slice(if no_reading { NO_READING } else { token });
        found |= no_reading;
        rest = after;
    }
    found.then_some(json)
}

/// Bytes of the text that begins with a quotation mark here.
fn text_length(bytes: &[u8]) -> usize {
    let mut escaped = false;
    let end = bytes.iter().skip(1).position(|&byte| {
        let ends = byte == b'"' && !escaped;
        escaped = byte == b'\\' && !escaped;
        ends
    });
    end.map_or(bytes.len(), |end| end + 2)
}

fn length_until(bytes: &[u8], ends: impl Fn(u8) -> bool) -> usize {
    let end = bytes.iter().position(|&byte| ends(byte));
    end.unwrap_or(bytes.len())
}

fn ends_value(byte: u8) -> bool {
    byte.is_ascii_whitespace() || b"\"{}[],:".contains(&byte)
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

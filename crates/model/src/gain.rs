//! The unknown gain between two positions of which at least one is in raw counts.
//!
//! In slow motion a link follows its motor side except for its deformation: `y = g (u + a u'' + b u') +
//! offset`. `g` by least squares converts the reading to the motor side's unit. Its remaining error is fitted
//! with everything else: the motion is a column beside the offset. A deformation says nothing of its gain without
//! a model: there the prediction is the column.

use super::regression::Regression;
use quell_recording::{Channel, Recording, Role};
use quell_signal::{CubicSpline, End};

/// Units of positions without a scale.
const RAW: &[&str] = &["count", "raw"];

/// Conversion of the reading of a link to the motor side's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Gain {
    /// What is read.
    pub channel: Role,
    /// Reading of the sensor for a unit of the motor side.
    pub value: f64,
    /// Unit of the reading.
    pub unit: String,
    /// The unit of the motor side.
    pub of: String,
}

/// Converts the link of a recording to the unit of its motor side, if the gain between them is unknown. Returns
/// the gain and the column for its error: the motor side at the link's stamps.
pub fn unify(recording: &mut Recording) -> Option<(Gain, Vec<f64>)> {
    let of = |roles: &[Role]| {
        let mut channels = recording.channels.iter();
        channels.position(|channel| roles.contains(&channel.role))
    };
    let motor = of(&[Role::MotorPosition]).or_else(|| of(&[Role::CommandPosition]))?;
    let link = of(&[Role::LinkPosition])?;
    let [motor, link] = [motor, link].map(|index| &recording.channels[index]);
    if !is_raw(motor) && !is_raw(link) {
        return None;
    }
    let spline = CubicSpline::new(&motor.time, &motor.columns[0], End::NotAKnot).ok()?;
    let at = |of: fn(&CubicSpline, f64) -> f64| -> Vec<f64> {
        link.time.iter().map(|&time| of(&spline, time)).collect()
    };
    let position = at(CubicSpline::value);
    // A slow deformation is proportional to the acceleration, its damping part to the rate.
    let slow = [
        at(CubicSpline::derivative),
        at(CubicSpline::second_derivative),
    ];
    let gain = Gain {
        channel: Role::LinkPosition,
        value: slope(&[&position, &slow[0], &slow[1]], &link.columns[0])?,
        unit: link.unit.clone(),
        of: motor.unit.clone(),
    };
    for channel in &mut recording.channels {
        if channel.role == Role::LinkPosition {
            let values = channel.columns.iter_mut().flatten();
            values.for_each(|value| *value /= gain.value);
            channel.unit.clone_from(&gain.of);
        }
    }
    Some((gain, position))
}

/// The gain of a deformation that is read in raw counts, or beside a motor side in raw counts, before a prediction
/// tells it: 1, and the column of its error. The deformation gets the motor side's unit.
pub fn of_deformation(recording: &mut Recording) -> Option<(Gain, Vec<f64>)> {
    let motor = recording.channel(Role::MotorPosition);
    let motor = motor.or_else(|| recording.channel(Role::CommandPosition))?;
    let (is_unknown, of) = (is_raw(motor), motor.unit.clone());
    let channels = &mut recording.channels;
    let read = channels
        .iter_mut()
        .find(|own| own.role == Role::Deformation)?;
    if !is_unknown && !is_raw(read) {
        return None;
    }
    let gain = Gain {
        channel: read.role,
        value: 1.0,
        unit: std::mem::replace(&mut read.unit, of.clone()),
        of,
    };
    Some((gain, read.columns[0].clone()))
}

fn is_raw(channel: &Channel) -> bool {
    RAW.contains(&channel.unit.as_str())
}

/// The slope of a reading over the first of some causes, fitted with an offset and the other causes; `None`
/// where the first does not vary.
pub(super) fn slope(causes: &[&[f64]], reading: &[f64]) -> Option<f64> {
    let slope = Regression::on(causes)?.slope(reading)?.value;
    (slope != 0.0).then_some(slope)
}

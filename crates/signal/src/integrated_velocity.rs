//! The position of which only the velocity was measured.

use super::SignalError;
use super::spline::{CubicSpline, End};
use quell_recording::{Channel, Role};

/// The motor side's position of its velocity: the integral of the spline through it, from 0 on.
///
/// # Errors
/// [`SignalError`] where the channel is no time series.
pub fn integrated_velocity(velocity: &Channel) -> Result<Channel, SignalError> {
    let (time, rate) = (&velocity.time, &velocity.columns[0]);
    let spline = CubicSpline::new(time, rate, End::NotAKnot)?;
    let (mut position, mut at) = (vec![0.0], 0.0);
    for k in 1..time.len() {
        let h = time[k] - time[k - 1];
        let bend = spline.second(k - 1) + spline.second(k);
        at += h * (0.5 * (rate[k - 1] + rate[k]) - h * h * bend / 24.0);
        position.push(at);
    }
    Ok(Channel {
        role: Role::MotorPosition,
        unit: velocity.unit.trim_end_matches("/s").into(),
        time: time.clone(),
        columns: vec![position],
    })
}

//! The smooth step from which cross-fades and corrections are made.

use crate::Setpoint;

/// Step from 0 to 1 over `0 <= x <= 1`, and its first and second derivative by `x`.
///
/// `s = 10 x^3 - 15 x^4 + 6 x^5`: position, velocity and acceleration are continuous, and the jerk
/// is bounded by 60. Below 0 it is 0, above 1 it is 1.
pub(crate) fn smooth_step(x: f64) -> Setpoint {
    if x <= 0.0 {
        return Setpoint::at_rest(0.0);
    }
    if x >= 1.0 {
        return Setpoint::at_rest(1.0);
    }
    let rest = 1.0 - x;
    Setpoint {
        position: x * x * x * (10.0 + x * (6.0 * x - 15.0)),
        velocity: 30.0 * x * x * rest * rest,
        acceleration: 60.0 * x * rest * (1.0 - 2.0 * x),
    }
}

/// The step over `ticks` ticks of `sample_time` s, `elapsed` ticks after its start, derivatives by
/// time.
pub(crate) fn step_at(elapsed: f64, ticks: usize, sample_time: f64) -> Setpoint {
    let width = ticks as f64;
    let duration = width * sample_time;
    let step = smooth_step(elapsed / width);
    Setpoint {
        position: step.position,
        velocity: step.velocity / duration,
        acceleration: step.acceleration / (duration * duration),
    }
}

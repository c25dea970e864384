//! A recording for a model that takes the second derivative of a recorded position.

use quell_recording::Channel;
use quell_signal::Course;

/// Smooths the position.
///
/// White noise `s` of a position of `T` between samples is `sqrt(6) s / T^2` of its second difference: 1e-5 rad at 500 Hz are 6 rad/s^2.
/// The position is replaced by [`Course`], whose bandwidth is the likeliest. One that never moves, or is no time series, stays as it is.
pub(super) fn smooth(position: &mut Channel) {
    let course = Course::of(position).ok().filter(|own| own.fastest > 0.0);
    if let Some(course) = course {
        position.columns[0] = course.state.iter().map(|state| state[0]).collect();
    }
}

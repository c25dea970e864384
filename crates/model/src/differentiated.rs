//! A recording for a model that takes the second derivative of a recorded position.

use quell_recording::{Recording, Role};
use quell_signal::Course;

/// Smooths the position, and leaves out the force at rest.
///
/// White noise `s` of a position of `T` between samples is `sqrt(6) s / T^2` of its second difference: 1e-5 rad at 500 Hz are 6 rad/s^2.
/// The position is replaced by [`Course`], whose bandwidth is the likeliest. At rest friction holds whatever it can bear,
/// so what the force is there no motion tells. A position that never moves, or is no time series, stays as it is. Returns the
/// [response](Course::response_of_error) of the error of the smoothed position.
pub(super) fn smooth(
    recording: &mut Recording,
    position: usize,
    forces: &[Role],
) -> Option<Vec<f64>> {
    let channel = &mut recording.channels[position];
    let course = Course::of(channel).ok().filter(|own| own.fastest > 0.0)?;
    channel.columns[0] = course.state.iter().map(|state| state[0]).collect();
    let forces = recording
        .channels
        .iter_mut()
        .filter(|own| forces.contains(&own.role));
    for force in forces {
        let moving: Vec<bool> = force.time.iter().map(|time| course.moves(*time)).collect();
        let keep = |values: &mut Vec<f64>| {
            let mut each = moving.iter();
            values.retain(|_| each.next().is_some_and(|moves| *moves));
        };
        [&mut force.time]
            .into_iter()
            .chain(&mut force.columns)
            .for_each(keep);
    }
    Some(course.response_of_error())
}

//! The limits of a simulation's effort, checked before it begins.

use super::CliError;
use crate::plant::{ModeOfJoint, Robot};

/// The most samples that any channel of a simulation may have, and steps of its integration: 5 hours
/// at 250 Hz, 80 MB a column, some ten seconds of work.
const MOST_STEPS: f64 = 5e6;

/// Refuses a simulation that would fill the memory or take far too long.
///
/// The integration takes a step for each radian of the fastest part of the chain.
///
/// # Errors
/// [`CliError::Input`] where `duration` (s) would take more than five million samples or steps.
pub fn affordable(duration: f64, robot: &Robot, modes: &[ModeOfJoint]) -> Result<(), CliError> {
    let rates = [robot.control_rate, robot.encoder.rate, robot.tracker.rate];
    let chain = modes.iter().map(|entry| entry.mode.natural_frequency());
    let chain = chain.chain([robot.servo.bandwidth]);
    let (samples, steps) = (
        duration * rates.into_iter().fold(0.0, f64::max),
        duration * chain.fold(0.0, f64::max),
    );
    let refuse = |count: f64, what: &str| {
        Err(CliError::input(format!(
            "simulating {duration} s takes {count:.3e} {what}; at most {MOST_STEPS:.0} are made"
        )))
    };
    match (samples <= MOST_STEPS, steps <= MOST_STEPS) {
        (true, true) => Ok(()),
        (false, _) => refuse(samples, "samples"),
        (true, false) => refuse(steps, "steps of integration"),
    }
}

//! What the joint is commanded to do, instant by instant.

use crate::cli::CliError;
use crate::plant::Robot;

/// The most samples that any channel of a simulation may have: 5 hours at 250 Hz, 80 MB a column.
const MOST_SAMPLES: f64 = 5e6;

/// Where the command is at an instant; a cubic leads from one to the next.
#[derive(Clone, Copy, Debug)]
pub struct Knot {
    /// Since the start, s.
    pub time: f64,
    /// rad.
    pub position: f64,
    /// rad/s.
    pub velocity: f64,
}

/// One move: the command changes from `from` to `until` (s) and so leads from `start` to `target`
/// (rad).
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// s.
    pub from: f64,
    /// s.
    pub until: f64,
    /// rad.
    pub start: f64,
    /// rad.
    pub target: f64,
}

/// A command from rest, and the moves in it.
#[derive(Debug)]
pub struct Motion {
    /// At least two, the first at time 0 and at rest.
    pub knots: Vec<Knot>,
    /// Moves with rest between them.
    pub legs: Vec<Leg>,
    /// Step of the positions, rad: their last digit, or that of a floating-point number.
    pub resolution: f64,
    /// What shaping adds to the end of a move, s.
    pub added_delay: f64,
    /// Stamp of the first knot on the clock that the command was recorded with, s.
    pub stamp: f64,
    /// What the user should know of it.
    pub remarks: Vec<String>,
}

/// The step of floating-point numbers as large as the positions, with a digit to spare.
pub fn rounding(knots: &[Knot]) -> f64 {
    let largest = knots.iter().map(|knot| knot.position.abs());
    4.0 * f64::EPSILON * largest.fold(0.0, f64::max)
}

impl Motion {
    /// Until when a leg's vibration is left alone: the next leg's beginning, or the end, s.
    pub fn watched_until(&self, leg: usize) -> f64 {
        let end = self.knots.last().map_or(0.0, |knot| knot.time);
        self.legs.get(leg + 1).map_or(end, |next| next.from)
    }
}

/// Refuses what would fill the memory.
///
/// # Errors
/// [`CliError::Input`] where a channel would have more than five million samples.
pub fn affordable(duration: f64, robot: &Robot) -> Result<(), CliError> {
    let rates = [robot.control_rate, robot.encoder.rate, robot.tracker.rate];
    let rate = rates.into_iter().fold(0.0, f64::max);
    if duration * rate <= MOST_SAMPLES {
        return Ok(());
    }
    Err(CliError::input(format!(
        "{duration} s at {rate} Hz are {:.0} samples; at most {MOST_SAMPLES:.0} are simulated",
        duration * rate
    )))
}

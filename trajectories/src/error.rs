//! Errors of a move, found before Ruckig gets it or reported by Ruckig itself.

use thiserror::Error;

/// Why a move cannot be planned or sampled.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlanError {
    /// The number of axes is not within 1 to 7.
    #[error("a move has 1 to 7 axes, not {given}")]
    DegreesOfFreedom {
        /// The number asked for.
        given: usize,
    },
    /// A list does not have one entry for each axis.
    #[error("{what}: {given} entries for {expected} axes")]
    Length {
        /// Which list.
        what: &'static str,
        /// Number of axes.
        expected: usize,
        /// Length of the list.
        given: usize,
    },
    /// A value is not finite, not positive, or outside of the range that Ruckig is tested for.
    #[error("axis {axis}: {what} is {}, it must be {rule}", plain(*.value))]
    Value {
        /// Axis, counted from 0.
        axis: usize,
        /// Which quantity.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The rule that it breaks.
        rule: &'static str,
    },
    /// The target state itself breaks a limit.
    #[error("axis {axis}: target {what} {value} is beyond the limit {limit}")]
    TargetBeyondLimit {
        /// Axis, counted from 0.
        axis: usize,
        /// Velocity or acceleration.
        what: &'static str,
        /// The target's value.
        value: f64,
        /// The limit of its magnitude.
        limit: f64,
    },
    /// The target can only be reached from a velocity that breaks the limit.
    #[error(
        "axis {axis}: the target's velocity and acceleration can only be reached from a velocity of \
         {value}, beyond the limit {limit}"
    )]
    TargetUnreachable {
        /// Axis, counted from 0.
        axis: usize,
        /// Velocity at which the acceleration towards the target must begin.
        value: f64,
        /// The limit of its magnitude.
        limit: f64,
    },
    /// The move would last longer than Ruckig supports.
    #[error("the move would last {duration} s, longer than the {limit} s that Ruckig supports")]
    TooLong {
        /// Duration, s (NaN if Ruckig did not say).
        duration: f64,
        /// Longest duration, s.
        limit: f64,
    },
    /// Ruckig found no profile for one of the axes on its own (its step 1).
    #[error("Ruckig found no time-optimal profile for axis {axis} within its limits")]
    NoProfile {
        /// Axis, counted from 0.
        axis: usize,
    },
    /// Ruckig found a profile for each axis, but no common duration (its step 2).
    #[error("Ruckig found no common duration for the {axes} axes of this move")]
    NoCommonDuration {
        /// Number of axes.
        axes: usize,
    },
    /// Ruckig refused or failed for another reason.
    #[error("Ruckig failed with {code}")]
    Ruckig {
        /// The name of its result code.
        code: String,
    },
    /// A profile that does not end at the target.
    #[error("axis {axis}: the trajectory misses the target {what} by {error}")]
    Inexact {
        /// Axis, counted from 0.
        axis: usize,
        /// Position, velocity or acceleration.
        what: &'static str,
        /// Distance from the target.
        error: f64,
    },
    /// The sampling period is not finite and above 0.
    #[error("the sampling period is {period} s, it must be finite and above 0")]
    Period {
        /// The period asked for, s.
        period: f64,
    },
    /// The trajectory would need too many samples.
    #[error("{duration} s at a period of {period} s are more than {limit} samples an axis")]
    TooManySamples {
        /// Duration of the trajectory, s.
        duration: f64,
        /// The period asked for, s.
        period: f64,
        /// The most samples for each axis.
        limit: usize,
    },
}

/// A number with all its digits, or with its power of ten where these would fill the line.
fn plain(value: f64) -> String {
    match value.abs() < 1e15 {
        true => value.to_string(),
        false => format!("{value:e}"),
    }
}

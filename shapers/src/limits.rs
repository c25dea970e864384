//! Limits of a move, and how near a command comes to them.

use crate::filter::shape;
use crate::{GridTrain, Setpoint, ShaperError};
use num_traits::Float;

/// Largest velocity, acceleration and jerk of one axis (rad/s, rad/s^2, rad/s^3, or m ...).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionLimits {
    /// Largest velocity.
    pub velocity: f64,
    /// Largest acceleration.
    pub acceleration: f64,
    /// Largest jerk.
    pub jerk: f64,
}

impl MotionLimits {
    /// Checks that all three are above 0; infinity means no limit.
    ///
    /// # Errors
    /// [`ShaperError::OutOfRange`].
    pub fn check(&self) -> Result<(), ShaperError> {
        let all = [
            ("velocity limit", self.velocity),
            ("acceleration limit", self.acceleration),
            ("jerk limit", self.jerk),
        ];
        for (name, value) in all {
            if value.is_nan() || value <= 0.0 {
                return Err(ShaperError::OutOfRange { name, value });
            }
        }
        Ok(())
    }
}

/// Peaks of a command over its limits; 1 is at the limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PeakRatios {
    /// Largest velocity over its limit.
    pub velocity: f64,
    /// Largest acceleration over its limit.
    pub acceleration: f64,
    /// Largest jerk, the difference of the accelerations of two ticks over the tick, over its limit.
    pub jerk: f64,
}

impl PeakRatios {
    /// The largest of the three.
    pub fn worst(&self) -> f64 {
        self.velocity.max(self.acceleration).max(self.jerk)
    }

    /// By how much to stretch the move in time to keep the limits: at least 1.
    ///
    /// Stretching by `s` divides velocity, acceleration and jerk by `s`, `s^2` and `s^3`. A train
    /// does not stretch with the move, so check the stretched move again.
    pub fn stretch(&self) -> f64 {
        let by_acceleration = Float::sqrt(self.acceleration);
        self.velocity
            .max(by_acceleration)
            .max(Float::cbrt(self.jerk))
            .max(1.0)
    }

    pub(crate) fn of_tick(
        before: Setpoint,
        now: Setpoint,
        limits: &MotionLimits,
        sample_time: f64,
    ) -> Self {
        let jerk = (now.acceleration - before.acceleration) / sample_time;
        Self {
            velocity: now.velocity.abs() / limits.velocity,
            acceleration: now.acceleration.abs() / limits.acceleration,
            jerk: jerk.abs() / limits.jerk,
        }
    }

    /// The least peaks of a command between two ticks, whatever happens there: the means of velocity and
    /// acceleration, and by `v1 - v0 - h (a0 + a1) / 2 = -int (t - h/2) j dt` the jerk, as that is at most
    /// `h^2 / 4` of its peak. A step that is over within two ticks shows in nothing else.
    pub(crate) fn between(
        before: Setpoint,
        now: Setpoint,
        limits: &MotionLimits,
        sample_time: f64,
    ) -> Self {
        let velocity = (now.position - before.position) / sample_time;
        let acceleration = (now.velocity - before.velocity) / sample_time;
        let bend = acceleration - 0.5 * (before.acceleration + now.acceleration);
        Self {
            velocity: velocity.abs() / limits.velocity,
            acceleration: acceleration.abs() / limits.acceleration,
            jerk: 4.0 * bend.abs() / (sample_time * limits.jerk),
        }
    }

    pub(crate) fn max(self, other: Self) -> Self {
        Self {
            velocity: self.velocity.max(other.velocity),
            acceleration: self.acceleration.max(other.acceleration),
            jerk: self.jerk.max(other.jerk),
        }
    }
}

/// How near a shaped move comes to its limits: for shapers with negative impulses ([`crate::UmZv`]),
/// which can exceed limits that the planned move keeps.
///
/// * `command`: the setpoints at the ticks, from rest;
/// * `sample_time`: s.
///
/// # Example
/// ```
/// use quell_shapers::{MotionLimits, Setpoint, peak_ratios};
/// let limits = MotionLimits { velocity: 1.0, acceleration: 2.0, jerk: 100.0 };
/// let command = [Setpoint { position: 0.1, velocity: 0.5, acceleration: 1.0 }];
/// let peaks = peak_ratios(command, &limits, 0.01);
/// assert_eq!((peaks.velocity, peaks.acceleration, peaks.jerk), (0.5, 0.5, 1.0));
/// ```
pub fn peak_ratios(
    command: impl IntoIterator<Item = Setpoint>,
    limits: &MotionLimits,
    sample_time: f64,
) -> PeakRatios {
    let mut before = Setpoint::default();
    let mut peaks = PeakRatios::default();
    for now in command {
        peaks = peaks.max(PeakRatios::of_tick(before, now, limits, sample_time));
        before = now;
    }
    peaks
}

/// [`peak_ratios`] of a planned move as a train will shape it, without running a filter.
///
/// `planned`: the setpoints at the ticks of the train's grid, from rest; after the last it stays
/// there. No allocation; cost proportional to the ticks times the taps.
pub fn shaped_peak_ratios(
    train: &GridTrain,
    planned: &[Setpoint],
    limits: &MotionLimits,
) -> PeakRatios {
    let start = Setpoint::at_rest(planned.first().map_or(0.0, |first| first.position));
    let end = Setpoint::at_rest(planned.last().map_or(0.0, |last| last.position));
    let command = (0..planned.len() + train.duration_in_ticks()).map(|k| {
        shape(train, |age| match k.checked_sub(age) {
            Some(index) => planned.get(index).copied().unwrap_or(end),
            None => start,
        })
    });
    peak_ratios(command, limits, train.sample_time())
}

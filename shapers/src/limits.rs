//! Limits of a move, and how near a command comes to them.

use crate::{Setpoint, ShaperError};

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

    /// By how much a move must be stretched in time to keep the limits: at least 1.
    ///
    /// Stretching by `s` divides velocity, acceleration and jerk by `s`, `s^2` and `s^3`.
    pub fn stretch(&self) -> f64 {
        use num_traits::Float;
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

//! A mode with its uncertainty.

use crate::Mode;

/// 95 % of a Gaussian lie within two standard deviations.
pub(crate) const WITHIN: f64 = 2.0;

/// A mode with its uncertainty: independent Gaussian errors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertainMode {
    /// The estimate.
    pub mode: Mode,
    /// Standard deviation of the natural frequency, rad/s.
    pub natural_frequency_std: f64,
    /// Standard deviation of the damping ratio.
    pub damping_ratio_std: f64,
}

impl UncertainMode {
    /// Whether another mode is within a standard deviation of this one, in frequency and in damping.
    pub fn is_near(&self, other: Mode) -> bool {
        let across = other.natural_frequency() - self.mode.natural_frequency();
        let along = other.damping_ratio() - self.mode.damping_ratio();
        across.abs() <= self.natural_frequency_std && along.abs() <= self.damping_ratio_std
    }
}

//! The priors of the unknowns before the first sample.

use crate::estimators::Settings;

/// Gaussian priors of all unknowns: `ln w`, `xi`, then the linear ones.
#[derive(Clone, Copy, Debug)]
pub struct Priors {
    /// Means of `ln w` and `xi`.
    pub mean: [f64; 2],
    /// Inverse variances of the eight unknowns.
    pub precision: [f64; 8],
}

impl Priors {
    /// Means and inverse variances. A belief is weak (the whole range of frequencies, a fifth in damping);
    /// sensor errors are those of the settings. Values that change with the samples are left at 0.
    pub fn believed(settings: &Settings) -> Self {
        let (low, high) = settings.frequency_range;
        let (mean, damping) = match settings.belief {
            Some(mode) => (mode.natural_frequency().ln(), mode.damping_ratio()),
            None => (0.5 * (low * high).ln(), 0.1),
        };
        Self {
            mean: [mean, damping],
            precision: [
                inverse_square((0.5 * (high / low).ln()).max(0.1)),
                inverse_square(0.2),
                0.0,
                0.0,
                settings.offset_std.map_or(0.0, inverse_square),
                0.0,
                inverse_square(settings.scale_std),
                inverse_square(settings.gain_std),
            ],
        }
    }
}

/// `1 / std^2`; a large number for a standard deviation of 0.
pub fn inverse_square(std: f64) -> f64 {
    if std > 0.0 { (std * std).recip() } else { 1e30 }
}

//! What two known modes leave of samples.

use super::super::two_mode_likelihood::{Pair, PairPriors, fit_linear};
use super::super::{Sample, Settings};
use quell_shapers::Mode;

/// Two modes of given frequencies and damping ratios, and what they leave of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct TwoModeResidual {
    /// Share of each mode in what a motion of the motor side shows; both add up to 1.
    pub shares: [f64; 2],
    /// `a` and `b` of each mode's free vibration `Re((a - j b) e^(lambda t))`, `t` from the first sample on.
    pub free: [[f64; 2]; 2],
    /// Offset of the deformation.
    pub offset: f64,
    /// Measured deformation less the fitted one, at each sample.
    pub residual: Vec<f64>,
}

/// The linear unknowns of [`TwoModeLikelihood`](crate::estimators::TwoModeLikelihood) by least squares, its modes being
/// known. `None` where the samples do not determine them.
pub fn two_mode_residual(
    samples: &[Sample],
    modes: [Mode; 2],
    noise_std: f64,
    settings: &Settings,
) -> Option<TwoModeResidual> {
    let priors = PairPriors::of_known_noise(settings, modes, noise_std);
    let pair = Pair::along(samples, modes, settings.sample_time, |_| {});
    let fit = fit_linear(&pair, &priors, noise_std * noise_std)?;
    let mut residual = Vec::with_capacity(samples.len());
    Pair::along(samples, modes, settings.sample_time, |pair| {
        residual.push(pair.weighed(&fit.residual));
    });
    let (free, offset) = fit.undriven();
    Some(TwoModeResidual {
        shares: fit.shares,
        free,
        offset,
        residual,
    })
}

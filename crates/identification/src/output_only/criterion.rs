//! The Bayesian criterion by which models of free decays are chosen.

use super::damped::{Damped, Fit};
use super::least_squares::by_first_lag;

/// Number of unknowns of a model: of its modes, and amplitudes and offset of each axis of each decay.
pub fn unknowns(model: &Fit, axes: usize) -> f64 {
    let of = |mode: &Damped| mode.unknowns() + 2 * axes;
    model.modes.iter().map(of).sum::<usize>() as f64
}

/// The place of the model with the best Bayesian criterion, and the number of independent samples of what the last
/// one leaves.
pub fn best(models: &[Fit], axes: usize) -> Option<(usize, f64)> {
    let left = &models.last()?.minimum.residual;
    let independent = by_first_lag(left, left.len());
    let score = |model: &Fit| {
        independent * model.minimum.cost.ln() + unknowns(model, axes) * independent.ln()
    };
    let scores = models.iter().map(score).enumerate();
    let best = scores.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((best.0, independent))
}

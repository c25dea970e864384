//! The Bayesian criterion by which models of free decays are chosen.

use super::damped::{Damped, Fit, Segment};
use super::least_squares::independent;
use super::level::level;

/// Number of unknowns of a model: of its modes, and amplitudes and offset of each axis of each decay.
pub fn unknowns(model: &Fit, axes: usize) -> f64 {
    let of = |mode: &Damped| 2 + 2 * usize::from(mode.bend.is_some()) + 2 * axes;
    model.modes.iter().map(of).sum::<usize>() as f64
}

/// The place of the model with the best Bayesian criterion, and the number of independent samples of what the last
/// one leaves.
///
/// A feature raises the likelihood by `N ln` of the ratio of the costs, but by no more than their difference over the noise that is
/// left at its mode: features of what drives a mode on are no laws of it.
pub fn best(models: &[Fit], segments: &[Segment], axes: usize) -> Option<(usize, f64)> {
    let left = &models.last()?.minimum.residual;
    let independent = independent(left, left.len());
    let mut score = 0.0;
    let mut best = (0, score);
    for (before, place) in (1..models.len()).enumerate() {
        let [before, model] = [&models[before], &models[place]];
        let (had, cost) = (before.minimum.cost, model.minimum.cost);
        let added = feature(before, model)?;
        let noise = level(segments, &model.modes, &model.minimum.residual, added);
        score += (independent * (had / cost).ln()).min((had - cost) / noise);
        score -= (unknowns(model, axes) - unknowns(before, axes)) * independent.ln();
        if score > best.1 {
            best = (place, score);
        }
    }
    Some((best.0, independent))
}

/// The mode that a model has more than another, or of which it has the dependence on the amplitude.
fn feature<'a>(before: &Fit, model: &'a Fit) -> Option<&'a Damped> {
    let had = |place: usize| before.modes.get(place).map(|mode| mode.bend.is_some());
    let modes = model.modes.iter().enumerate();
    let mut new = modes.filter(|(place, mode)| had(*place) != Some(mode.bend.is_some()));
    new.next().map(|(_, mode)| mode)
}

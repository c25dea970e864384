//! Which of the stretches are held out: those that go least beyond what the others visit.
//!
//! What acts in the held-out stretches alone cannot be learned from the others. Examples are a limit of the drive that only the
//! largest force reaches, and an end stop that only the longest move meets. No structure then predicts what was held out, and the
//! search has no direction. So held-out stretches are to test interpolation as far as a recording allows.
//!
//! Source: Snee, Validation of regression models, Technometrics 19 (1977), for splits whose parts cover the same region.

use super::range::{EMPTY, widen};
use super::split::{EVERY, parts};
use quell_model::Experiment;
use quell_model::effects::KNOTS;

/// First stretches that may be held out. The very first one shows the start: what friction holds there stays until the motion
/// begins. Where both are alike, the recording begins and ends with fitted stretches.
const FIRST: [usize; 2] = [1, 2];
/// Parts of a stretch over which a change is taken: a stretch has three periods, so that a part is a tenth of a period.
const PARTS: usize = 30;

/// The index of the first stretch that is held out.
pub fn least_beyond(experiments: &[Experiment], stretch: f64) -> usize {
    let costs = FIRST.map(|from| beyond(experiments, stretch, from));
    FIRST[usize::from(costs[1] < costs[0])]
}

/// By how much held-out stretches go beyond the fitted ones: the sum over input, outputs and their changes, each as a share of
/// its range.
fn beyond(experiments: &[Experiment], stretch: f64, from: usize) -> f64 {
    let of_series = |index: usize| {
        let [mut fitted, mut held] = [[EMPTY; 2]; 2];
        for experiment in experiments {
            let Some((time, values)) = series(experiment).nth(index) else {
                continue;
            };
            for (k, rows) in parts(experiment, time, stretch).into_iter().enumerate() {
                let part = if k % EVERY == from {
                    &mut held
                } else {
                    &mut fitted
                };
                visit(part, &values[rows]);
            }
        }
        (0..2).map(|k| excess(fitted[k], held[k])).sum::<f64>()
    };
    let most = experiments.iter().map(|own| series(own).count()).max();
    (0..most.unwrap_or(0)).map(of_series).sum()
}

/// Input and outputs.
fn series(experiment: &Experiment) -> impl Iterator<Item = (&[f64], &[f64])> {
    let input = (&experiment.input_time[..], &experiment.input_values[..]);
    let outputs = experiment.outputs.iter();
    std::iter::once(input).chain(outputs.map(|own| (&own.time[..], &own.values[..])))
}

/// Extends the ranges of values and changes by those of a stretch.
fn visit([all, changes]: &mut [(f64, f64); 2], values: &[f64]) {
    let apart = (values.len() / PARTS).max(1);
    values.iter().for_each(|value| widen(all, *value));
    let later = values.iter().skip(apart);
    let pairs = values.iter().zip(later);
    pairs.for_each(|(before, after)| widen(changes, after - before));
}

/// The part of the held-out range outside of the fitted one, as a share of both together; 0 where it is less than the distance of
/// a learned law's knots, to which a law over this range is resolved.
fn excess(fitted: (f64, f64), held: (f64, f64)) -> f64 {
    let whole = fitted.1.max(held.1) - fitted.0.min(held.0);
    let outside = (fitted.0 - held.0).max(0.0) + (held.1 - fitted.1).max(0.0);
    let seen = outside.is_finite() && outside * (KNOTS - 1) as f64 > whole;
    if seen { outside / whole } else { 0.0 }
}

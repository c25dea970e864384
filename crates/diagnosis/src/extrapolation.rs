//! Which of the stretches are held out: those that go least beyond what the others visit.
//!
//! What acts in the held-out stretches alone cannot be learned from the others. Examples are a limit of the drive that only the
//! largest force reaches, and an end stop that only the longest move meets. No structure then predicts what was held out, and the
//! search has no direction. So held-out stretches are to test interpolation as far as a recording allows.
//!
//! Source: Snee, Validation of regression models, Technometrics 19 (1977), for splits whose parts cover the same region.

use super::split::{EVERY, parts};
use quell_model::Experiment;
use quell_model::effects::KNOTS;
use std::ops::Range;

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
        let mut spans = [EMPTY; 2];
        for experiment in experiments {
            let Some((time, values)) = series(experiment).nth(index) else {
                continue;
            };
            for (k, rows) in parts(experiment, time, stretch).into_iter().enumerate() {
                let part = usize::from(k % EVERY == from);
                for (own, next) in spans[part].iter_mut().zip(visited(values, rows)) {
                    *own = [own[0].min(next[0]), own[1].max(next[1])];
                }
            }
        }
        let [fitted, held] = spans;
        fitted
            .into_iter()
            .zip(held)
            .map(|(f, h)| excess(f, h))
            .sum::<f64>()
    };
    let most = experiments.iter().map(|own| series(own).count()).max();
    (0..most.unwrap_or(0)).map(of_series).sum()
}

/// Least and greatest value and change.
type Spans = [[f64; 2]; 2];

const EMPTY: Spans = [[f64::INFINITY, f64::NEG_INFINITY]; 2];

/// Input and outputs.
fn series(experiment: &Experiment) -> impl Iterator<Item = (&[f64], &[f64])> {
    let input = (&experiment.input_time[..], &experiment.input_values[..]);
    let outputs = experiment.outputs.iter();
    std::iter::once(input).chain(outputs.map(|own| (&own.time[..], &own.values[..])))
}

fn visited(values: &[f64], rows: Range<usize>) -> Spans {
    let own = &values[rows];
    let apart = (own.len() / PARTS).max(1);
    let span = |values: &mut dyn Iterator<Item = f64>| {
        values
            .filter(|v| v.is_finite())
            .fold(EMPTY[0], |[low, high], v| [low.min(v), high.max(v)])
    };
    let mut changes = own.iter().zip(own.iter().skip(apart)).map(|(a, b)| b - a);
    [span(&mut own.iter().copied()), span(&mut changes)]
}

/// The part of the held-out range outside of the fitted one, as a share of both together; 0 where it is less than the distance of
/// a learned law's knots, to which a law over this range is resolved.
fn excess(fitted: [f64; 2], held: [f64; 2]) -> f64 {
    let whole = fitted[1].max(held[1]) - fitted[0].min(held[0]);
    let outside = (fitted[0] - held[0]).max(0.0) + (held[1] - fitted[1]).max(0.0);
    let seen = outside.is_finite() && outside * (KNOTS - 1) as f64 > whole;
    if seen { outside / whole } else { 0.0 }
}

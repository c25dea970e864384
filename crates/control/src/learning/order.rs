//! The number of modes in a move: a further mode is added as long as the likelihood ratio excludes its absence.

use super::fit::{Fit, Problem};
use super::map::Predicted;
use super::path::NODES;
use super::point::{Point, Prior};
use crate::estimators::Sample;
use nalgebra::{SMatrix, SVector};

/// Most modes that are learned and shaped for.
pub const MOST: usize = 3;
/// Ratio of neighbouring frequencies of the grid: four periods resolve an eighth.
const RATIO: f64 = 1.07;
/// Damping ratio of the grid's modes.
const DAMPING: f64 = 0.03;
/// Number of starts for a further mode.
const STARTS: usize = 2;
/// Threshold of the likelihood ratio: the maximum over frequencies and dampings exceeds 30 by chance once in
/// thousands of moves (module `two_mode_likelihood`).
const CHANCE: f64 = 30.0;
/// Share of the sum of squares that is left if half of the amplitude is explained.
const MOST_OF: f64 = 0.25;
/// Unknowns of a mode.
const UNKNOWNS: f64 = 8.0;
/// Standard deviation of `ln w` above which a mode is not useful: two of them are the half width of ZVD's
/// insensitivity.
const USEFUL: f64 = 0.08;
/// Damping ratio above which there is no oscillation.
const RINGS: f64 = 0.35;
/// Part of the deformation that needs no train: the dead band.
const WORTH: f64 = 0.01;
/// Prior of `ln w` of an unknown mode: of its level, and over the pose per radian (a quarter of the inertia's).
const LEVEL: f64 = 0.3;
const POSE: f64 = 0.2;

/// The prior of a mode that was found at a frequency.
pub fn open_prior(log_w: f64, way: &[f64; NODES], damping: f64) -> Prior {
    let covariance = SMatrix::from_fn(|i, j| {
        let apart = way[i] - way[j];
        LEVEL * LEVEL + POSE * POSE * (-0.5 * apart * apart).exp()
    });
    Prior {
        log_w: Predicted {
            mean: SVector::repeat(log_w),
            covariance,
        },
        xi: (damping, 0.1 * 0.1),
    }
}

/// Fits the known modes, and as many more as there is evidence for.
///
/// If two modes are strong, the one that is left out colours the residual, so that the other alone is no
/// evidence. So two and three modes are tried even where one is not evident.
pub fn explain(samples: &[Sample], problem: &mut Problem<'_>, known: &[Prior]) -> Option<Fit> {
    let mut accepted = match known {
        [] => None,
        known => {
            let start: Vec<Point> = known.iter().map(Prior::point).collect();
            Some(problem.fit(&start, known)?)
        }
    };
    let nothing = problem.left_by(&[])?;
    let mut grown = accepted.clone();
    for _ in known.len()..MOST {
        if grown
            .as_ref()
            .is_some_and(|fit| is_all(fit, negligible(samples)))
        {
            break;
        }
        let Some(more) = one_more(samples, problem, grown.as_ref()) else {
            break;
        };
        let without = accepted.as_ref().map_or(nothing, |fit| fit.square);
        let before = accepted.as_ref().map_or(0, |fit| fit.modes.len());
        if is_evident(&more, before, without, negligible(samples))
            || (before == 0 && is_most(&more, without))
        {
            accepted = Some(more.clone());
        }
        grown = Some(more);
    }
    accepted
}

/// Whether one fit excludes another of as many samples and `more` modes fewer.
pub fn excludes(better: &Fit, worse: &Fit, samples: &[Sample]) -> bool {
    let more = better.modes.len().saturating_sub(worse.modes.len()) as f64;
    let evidence = log_likelihood_ratio(better, worse.square, negligible(samples));
    evidence > CHANCE + more * UNKNOWNS * independent(better).max(1.0).ln()
}

/// Twice the logarithm of the likelihood ratio of two fits of the same samples with as many unknowns. Of their residuals the
/// one of more colour counts.
pub fn evidence(one: &Fit, other: &Fit, samples: &[Sample]) -> f64 {
    let mean = |fit: &Fit| fit.square / fit.samples.max(1.0) + negligible(samples);
    let independent = independent(one).min(independent(other));
    independent * (mean(other) / mean(one)).ln()
}

/// Number of independent samples of a fit.
fn independent(fit: &Fit) -> f64 {
    fit.samples / fit.inflation
}

/// Log likelihood ratio of a fit against a model with sum of squares `square` of the same samples. Motion below
/// the dead band counts as noise.
fn log_likelihood_ratio(fit: &Fit, square: f64, negligible: f64) -> f64 {
    let floor = negligible * fit.samples;
    independent(fit) * ((square + floor) / (fit.square + floor)).ln()
}

/// Whether no further mode can be evident: at best it leaves the white part of the residual.
fn is_all(fit: &Fit, negligible: f64) -> bool {
    let (all, white) = (fit.variance, fit.variance - fit.unexplained());
    let gain = fit.samples * ((all + negligible) / (white + negligible)).ln();
    gain < CHANCE + UNKNOWNS * fit.samples.max(1.0).ln()
}

/// Mean square of motion that needs no train: the part [`WORTH`] of the deformation.
fn negligible(samples: &[Sample]) -> f64 {
    let n = samples.len() as f64;
    let mean = samples.iter().map(|s| s.deformation).sum::<f64>() / n;
    let square = samples
        .iter()
        .map(|s| (s.deformation - mean).powi(2))
        .sum::<f64>()
        / n;
    WORTH * WORTH * square
}

/// The fit with one more mode at the best of its starts.
fn one_more(samples: &[Sample], problem: &mut Problem<'_>, fit: Option<&Fit>) -> Option<Fit> {
    let present: Vec<Point> = fit.map_or(vec![], |f| f.modes.iter().map(|m| m.point).collect());
    let priors: Vec<Prior> = fit.map_or(vec![], |f| f.modes.iter().map(|m| m.prior).collect());
    let nodes = problem.way.nodes();
    let mut best: Option<Fit> = None;
    for log_w in starts(samples, problem, &present) {
        let prior = open_prior(log_w, &nodes, DAMPING);
        let mut priors = priors.clone();
        priors.push(prior);
        let mut start = present.clone();
        start.push(prior.point());
        let Some(found) = problem.fit(&start, &priors) else {
            continue;
        };
        if best.as_ref().is_none_or(|best| found.square < best.square) {
            best = Some(found);
        }
    }
    best
}

/// Whether the modes after the first `before` are evident and oscillate.
fn is_evident(found: &Fit, before: usize, without: f64, negligible: f64) -> bool {
    let more = found.modes.len() - before;
    let needed = more as f64 * (CHANCE + UNKNOWNS * independent(found).max(1.0).ln());
    log_likelihood_ratio(found, without, negligible) > needed
        && (before..found.modes.len()).all(|k| rings(found, k))
}

/// Whether one mode oscillates and explains most of the motion: then there is one, however coloured the
/// residual. The residual counts when a train is chosen.
fn is_most(found: &Fit, without: f64) -> bool {
    found.modes.len() == 1 && found.square < MOST_OF * without && rings(found, 0)
}

/// Whether a mode is useful: known well enough, oscillating, and different from the others.
///
/// A fit at the edge of the frequency range follows something else (backlash at the lower edge), and its
/// standard deviation there is not that of its error.
pub fn rings(found: &Fit, k: usize) -> bool {
    let end = NODES - 1;
    let mode = &found.modes[k];
    let std = |n: usize| mode.covariance[(n, n)].sqrt();
    let (log_w, (low, high)) = (mode.point.log_w[end], found.range);
    let inside = log_w - 2.0 * std(end) > low && log_w + 2.0 * std(end) < high;
    let apart = found.modes.iter().enumerate().all(|(other, with)| {
        let distance = with.point.log_w[end] - mode.point.log_w[end];
        let known = (with.covariance + mode.covariance)[(end, end)];
        other == k || distance * distance > 9.0 * known
    });
    inside && std(end) < USEFUL && mode.point.xi + 2.0 * std(NODES) < RINGS && apart
}

/// The best frequencies for a further mode, the best first.
fn starts(samples: &[Sample], problem: &Problem<'_>, present: &[Point]) -> Vec<f64> {
    let (low, high) = problem.range;
    let duration = samples[samples.len() - 1].time - samples[0].time;
    let rate = (samples.len() - 1) as f64 / duration.max(f64::MIN_POSITIVE);
    // With eight samples per period the parabola between them is accurate to a hundredth.
    let high = high.min((core::f64::consts::TAU * rate / 8.0).ln());
    let count = ((high - low) / RATIO.ln()).ceil().max(1.0) as usize;
    let left: Vec<(f64, f64)> = (0..=count)
        .filter_map(|k| {
            let log_w = low + (high - low) * k as f64 / count as f64;
            let mut points = present.to_vec();
            points.push(Point {
                log_w: [log_w; NODES],
                xi: DAMPING,
            });
            Some((log_w, problem.left_by(&points)?))
        })
        .collect();
    let mut bottoms: Vec<(f64, f64)> = (0..left.len())
        .filter(|&k| {
            let lower = |other: Option<&(f64, f64)>| other.is_none_or(|o| left[k].1 <= o.1);
            lower(k.checked_sub(1).and_then(|k| left.get(k))) && lower(left.get(k + 1))
        })
        .map(|k| left[k])
        .collect();
    bottoms.sort_by(|a, b| a.1.total_cmp(&b.1));
    bottoms.iter().take(STARTS).map(|b| b.0).collect()
}

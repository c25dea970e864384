//! Weights of an output's rows: its noise and, where the residuals of several outputs are far above the noise,
//! these residuals.

use super::noise::{LOUDER, noise};
use super::point::Point;
use super::problem::Problem;
use super::spread::spread;
use super::thresholds::FLOOR;
use super::whitening::Whitening;
use quell_model::Experiment;
use std::f64::consts::TAU;

/// A value for each experiment and output.
type Each<T> = Vec<Vec<T>>;

/// Sets level and colour of the noise and the weights from the residual at a point; they stay where there is none.
pub fn measure_noise(problem: &mut Problem, point: &Point) {
    let Some((own, left)) = measured(problem, point) else {
        return;
    };
    let noise = with_input_noise(problem, point, &own);
    tracing::debug!(?noise, "noise");
    problem.whitening = weights(problem, (&own, &noise), &left);
    (problem.sensor_noise, problem.noise) = (own, noise);
}

/// Sets noise and weights from a better model, if they differ from the present ones by more than chance: the
/// rough part of a mismatch is taken for noise until the mismatch is explained. Returns whether they do.
pub fn measured_again(problem: &mut Problem, point: &Point) -> bool {
    let Some((found, left)) = measured(problem, point) else {
        return false;
    };
    let mut own = problem.sensor_noise.clone();
    let new = found.into_iter().flatten().zip(left.iter().flatten());
    for (own, (new, left)) in own.iter_mut().flatten().zip(new) {
        // A better model does not add noise, so the lower estimate of a level counts. The exception is noise
        // that was only known by its roughness and taken for white: the residual may be noise of the same
        // roughness that is slower and louder.
        let quieter = LOUDER * new.deviation < own.deviation;
        let louder = new.deviation > LOUDER * own.deviation && own.coefficients.is_empty();
        let as_rough = || new.roughness() < LOUDER * own.deviation;
        let all = left.powi(2) < FLOOR * new.deviation.powi(2);
        if quieter || louder && all && as_rough() {
            *own = new;
        }
    }
    let noise = with_input_noise(problem, point, &own);
    let weights = weights(problem, (&own, &noise), &left);
    let before = problem.whitening.iter().flatten();
    let changed = before.zip(weights.iter().flatten()).any(|(old, new)| {
        let ratio = new.deviation / old.deviation;
        let hears_input = |own: &Whitening| !own.moving_average.is_empty();
        ratio.max(1.0 / ratio) > LOUDER || hears_input(old) != hears_input(new)
    });
    if changed {
        (problem.sensor_noise, problem.noise, problem.whitening) = (own, noise, weights);
    }
    changed
}

/// The noise of every output with that of the input.
fn with_input_noise(problem: &Problem, point: &Point, own: &[Vec<Whitening>]) -> Each<Whitening> {
    let each = own.iter().enumerate();
    each.map(|(e, own)| problem.with_input_noise(point, e, own))
        .collect()
}

/// Noise of every output's sensor, and the standard deviation of its residual; `None` where a simulation diverged, or
/// was skipped because the diagnosis is stopped.
fn measured(problem: &Problem, point: &Point) -> Option<(Each<Whitening>, Each<f64>)> {
    // Only for a mode the fall of the response above its frequency is known.
    let rates = match problem.kind.mode {
        Some((f, xi)) => (TAU * point.keys[f], TAU * point.keys[f] * point.keys[xi]),
        None => {
            let scales = &problem.scales;
            (
                f64::INFINITY,
                scales.natural_frequency * scales.damping_ratio,
            )
        }
    };
    let of = |(e, experiment): (usize, &Experiment)| {
        let raw = problem.explained(point, e);
        let pairs = experiment.outputs.iter().zip(&raw);
        let each = pairs.map(|(output, r)| (noise(experiment, output, r, rates), spread(r)));
        each.unzip()
    };
    let (own, left): (_, Each<f64>) = problem.experiments.iter().enumerate().map(of).unzip();
    let is_known = left.iter().flatten().all(|left| left.is_finite());
    is_known.then_some((own, left))
}

/// The noise, raised for outputs whose residuals are further above it than that of the nearest output.
///
/// Far above the noise a residual is the model's error, and the noise says nothing about its size in each
/// output: the quietest sensor would count alone. A model's error belongs to the motion, whichever sensor sees
/// it, so that outputs of one unit weigh alike. If the levels are unknown, the likelihood is `prod RSS_k^(-N_k
/// / 2)` over the units, and the weights are the levels themselves, of the sensors' own colour: how the chain
/// colours the noise of the input says nothing about a model's error. The nearest output keeps the level of its
/// whole noise, so that a search ends there. If one output shows only noise, the weights are those of the noise.
///
/// Source: Box and Draper, The Bayesian estimation of common parameters from several responses,
/// Biometrika 52 (1965), for outputs whose errors are independent.
fn weights(
    problem: &Problem,
    (own, noise): (&[Vec<Whitening>], &[Vec<Whitening>]),
    left: &[Vec<f64>],
) -> Each<Whitening> {
    let weigh = |(e, experiment): (usize, &Experiment)| {
        let (own, noise, left) = (&own[e], &noise[e], &left[e]);
        let above = noise
            .iter()
            .zip(left)
            .map(|(own, left)| left / own.deviation);
        let floor = above.fold(f64::INFINITY, f64::min);
        // A walk is told from a slow error of the model by its own rows alone.
        if floor * floor <= FLOOR || noise.iter().any(|own| own.walks) {
            return noise.clone();
        }
        let level = |k: usize| {
            let unit = &experiment.outputs[k].unit;
            let all = experiment.outputs.iter().zip(left);
            let same = all.filter(|(output, _)| output.unit == *unit);
            let squares: Vec<f64> = same.map(|(_, left)| left * left).collect();
            (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
        };
        let above = |k: usize| level(k) / noise[k].deviation;
        let least = (0..own.len()).map(above).fold(f64::INFINITY, f64::min);
        let louder = |k: usize| own[k].louder(level(k) / least / own[k].deviation);
        (0..own.len()).map(louder).collect()
    };
    problem.experiments.iter().enumerate().map(weigh).collect()
}

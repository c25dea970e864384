//! The given model, refitted: problem, noise floor, held-out part.

use super::fit::Fitted;
use super::noise::rounding;
use super::point::Point;
use super::problem::{Problem, Rows};
use super::projector::Projector;
use super::scales::scales;
use super::start::{departure_scale, departures};
use super::stop::Stop;
use super::thresholds::LONG;
use super::whitening::Whitening;
use quell_model::effects::Catalogue;
use quell_model::{Experiment, Model};
use std::sync::Arc;

/// Largest departure of a key from its believed value, in believed standard deviations. A value farther away
/// means another machine.
const FARTHEST: f64 = 3.0;

/// The problem of fitting a model to experiments. The noise is taken for white, at the level of third
/// differences.
pub fn problem<'a>(
    model: &Model,
    experiments: &'a [Experiment],
    rows: Vec<Vec<Rows>>,
) -> Problem<'a> {
    let kind = model.kind;
    let noise: Vec<Vec<Whitening>> = experiments.iter().map(first_guess).collect();
    let mut beliefs = Vec::new();
    let mut bounds = Vec::new();
    let mut free = Vec::new();
    let known = experiments.iter().all(|own| own.known.says_inertia());
    // Of a normalised kind it also says what the frequency is that of.
    let unused = (known && !kind.normalised).then(|| kind.key("link_inertia"));
    for (index, (key, value)) in kind.keys.iter().zip(&model.values).enumerate() {
        let std = value.std.map_or(key.belief, |std| match key.range.0 > 0.0 {
            true => std / value.value,
            false => std,
        });
        let unused = unused == Some(Some(index));
        if !unused && !value.fixed && std > 0.0 && (model.given[index] || key.default.is_none()) {
            free.push(index);
        }
        beliefs.push((value.value, if std > 0.0 { std } else { f64::INFINITY }));
        bounds.push(limits(key.range, value.bounds, value.value, std));
    }
    let scales = scales(kind, &model.keys(), experiments, model);
    let payloads = payloads(experiments);
    Problem {
        kind,
        // A known inertia includes the payload.
        free_payloads: 1..if known { 1 } else { payloads.len() },
        payloads,
        experiments,
        rows,
        whitening: noise.clone(),
        sensor_noise: noise.clone(),
        noise,
        rounding_at_rest: Arc::default(),
        free,
        beliefs,
        bounds,
        given: model.effects.iter().map(|e| e.parameters.clone()).collect(),
        departures: departures(model, experiments),
        departure_scale: departure_scale(&scales),
        catalogue: Catalogue::default(),
        scales_of_each: Vec::new(),
        scales,
        frozen: false,
        stop: Stop::default(),
        enough: Stop::default(),
        simulated: Arc::default(),
    }
}

/// The different payloads of the recordings; that of the first recording comes first.
pub fn payloads(experiments: &[Experiment]) -> Vec<Option<String>> {
    let mut found: Vec<Option<String>> = Vec::new();
    for experiment in experiments {
        if !found.contains(&experiment.payload) {
            found.push(experiment.payload.clone());
        }
    }
    found
}

fn limits(range: (f64, f64), given: Option<(f64, f64)>, value: f64, std: f64) -> (f64, f64) {
    if let Some((low, high)) = given {
        return (low.max(range.0), high.min(range.1));
    }
    let far = FARTHEST * std;
    let (low, high) = match range.0 > 0.0 {
        true => (value * (-far).exp(), value * far.exp()),
        false => (value - far, value + far),
    };
    (low.max(range.0), high.min(range.1))
}

pub fn first_guess(experiment: &Experiment) -> Vec<Whitening> {
    let guess = |output: &quell_model::Output| {
        let floor = quell_signal::noise_floor(&output.values).standard_deviation;
        let size = output.values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        // Least noise of a recording without any: the rounding of a number written with nine digits.
        let least = (1e-9 * size).max(f64::MIN_POSITIVE);
        let level = output.noise_witness.unwrap_or(floor);
        Whitening::white(level.max(least).max(rounding(output)))
    };
    experiment.outputs.iter().map(guess).collect()
}

/// The best fit from several starts of the frequency.
pub fn refit(problem: &mut Problem, start: &Point, projector: &Projector) -> Fitted {
    let mut starts = vec![start.clone()];
    if let Some((frequency, _)) = problem.kind.mode {
        for factor in [0.85, 0.93, 1.08, 1.18] {
            let mut other = start.clone();
            let (low, high) = problem.bounds[frequency];
            other.keys[frequency] = (other.keys[frequency] * factor).clamp(low, high);
            starts.push(other);
        }
    }
    let mut costs: Vec<(f64, Point)> = starts
        .into_iter()
        .map(|point| {
            let short = problem.fit(&point, projector, 3);
            (short.cost, short.point)
        })
        .collect();
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    problem.fit(&costs[0].1, projector, LONG)
}

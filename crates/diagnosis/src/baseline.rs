//! The given model, refitted: problem, noise floor, held-out part.

use super::fit::{Fitted, Projector};
use super::noise::rounding;
use super::point::Point;
use super::problem::{Problem, Rows};
use super::split::{self, HeldOut, Split};
use super::start::{departure_scale, departures};
use super::stop::Stop;
use super::thresholds::LONG;
use super::whitening::Whitening;
use quell_model::chain::MotorSide;
use quell_model::effects::{Catalogue, Scales, Visited};
use quell_model::{Departure, Experiment, Kind, Model, StartComponent, Trace, see_motion};
use quell_recording::Role;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Believed standard deviations beyond which a key of the model may not run: what is not known within
/// three of them is another machine.
const FARTHEST: f64 = 3.0;

/// Length of held-out stretches of time, in periods of the mode: long enough that the noise of one is
/// not the noise of its neighbours.
const STRETCH: f64 = 3.0;

/// Errors of a rigid axis that matter, as a share of its travel: what stands for the deformation.
const RIGID: f64 = 0.01;

/// The experiments of a diagnosis and what is held out of them.
pub struct Data {
    /// What is fitted.
    pub experiments: Vec<Experiment>,
    /// Its fitted rows.
    pub train: Vec<Vec<Rows>>,
    /// Its held-out rows; empty where whole recordings are held out.
    pub held_out: Vec<Vec<Rows>>,
    /// Recordings that are held out as a whole.
    pub apart: Vec<Experiment>,
    /// What is held out.
    pub judged_by: HeldOut,
}

impl Data {
    /// From experiments, and others that are held out; without these, stretches of them.
    pub fn new(model: &Model, experiments: Vec<Experiment>, apart: Vec<Experiment>) -> Self {
        let scales = scales(model.kind, &model.keys(), &experiments, model);
        let (mut train, mut held_out) = (Vec::new(), Vec::new());
        for experiment in &experiments {
            let parts = match apart.is_empty() {
                true => split::interleaved(experiment, STRETCH * scales.period()),
                false => Split {
                    train: split::whole(experiment),
                    held_out: vec![Vec::new(); experiment.outputs.len()],
                },
            };
            train.push(parts.train);
            held_out.push(parts.held_out);
        }
        let judged_by = match apart.is_empty() {
            true => HeldOut::Stretches,
            false => HeldOut::Recordings,
        };
        Self {
            experiments,
            train,
            held_out,
            apart,
            judged_by,
        }
    }

    /// The same in long steps of the integration, where that spares some.
    pub fn in_long_steps(&self, model: &Model) -> Option<Self> {
        let long = |all: &[Experiment]| -> Vec<Option<Experiment>> {
            all.iter().map(|own| own.in_long_steps(model)).collect()
        };
        let (experiments, apart) = (long(&self.experiments), long(&self.apart));
        experiments.iter().any(Option::is_some).then(|| {
            let or_own = |long: Vec<Option<Experiment>>, own: &[Experiment]| -> Vec<Experiment> {
                let pairs = long.into_iter().zip(own);
                pairs
                    .map(|(long, own)| long.unwrap_or_else(|| own.clone()))
                    .collect()
            };
            Self {
                experiments: or_own(experiments, &self.experiments),
                apart: or_own(apart, &self.apart),
                train: self.train.clone(),
                held_out: self.held_out.clone(),
                judged_by: self.judged_by,
            }
        })
    }
}

/// The problem of fitting a model to experiments; noise white, at the level of third differences.
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
    for (index, (key, value)) in kind.keys.iter().zip(&model.values).enumerate() {
        let std = value.std.map_or(key.belief, |std| match key.range.0 > 0.0 {
            true => std / value.value,
            false => std,
        });
        if !value.fixed && std > 0.0 && (model.given[index] || key.default.is_none()) {
            free.push(index);
        }
        beliefs.push((value.value, if std > 0.0 { std } else { f64::INFINITY }));
        bounds.push(limits(key.range, value.bounds, value.value, std));
    }
    let scales = scales(kind, &model.keys(), experiments, model);
    let payloads = payloads(experiments);
    Problem {
        kind,
        free_payloads: 1..payloads.len(),
        payloads,
        experiments,
        rows,
        whitening: noise.clone(),
        noise,
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
        simulated: Arc::default(),
    }
}

/// Different payloads, that of the first recording first.
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
        // A recording without any noise: the rounding of a number written with nine digits.
        let least = (1e-9 * size).max(f64::MIN_POSITIVE);
        let level = output.noise_witness.unwrap_or(floor);
        Whitening::white(level.max(least).max(rounding(&output.values)))
    };
    experiment.outputs.iter().map(guess).collect()
}

/// The departure of the start that makes a link as lively as its sensor, where its motor side stands
/// still throughout: all that is seen is then free decay.
fn rung(kind: &Kind, keys: &[f64], experiment: &Experiment) -> Departure {
    let mut start = Departure::default();
    let range = |values: &[f64]| {
        let fold = |(low, high): (f64, f64), v: &f64| (low.min(*v), high.max(*v));
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), fold);
        high - low
    };
    let linear = (kind.linear)(keys, experiment.input);
    if linear.motor == MotorSide::Prescribed && range(&experiment.input_values) == 0.0 {
        let output = &experiment.outputs[0];
        start[StartComponent::Deformation] = match output.role {
            Role::LinkAcceleration => 0.5 * range(&output.values) / linear.stiffness,
            _ => 0.5 * range(&output.values),
        };
    }
    start
}

/// The largest sizes that a motion reaches; what is not finite does not count.
struct Extremes {
    deformation: f64,
    deformation_rate: f64,
    /// Of the link's position.
    range: (f64, f64),
    velocity: f64,
    acceleration: f64,
    force: f64,
    visited: Visited,
}

/// The range of nothing yet.
const EMPTY: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// A range that holds a value, too; what is not finite does not count.
fn widen(range: &mut (f64, f64), value: f64) {
    if value.is_finite() {
        *range = (range.0.min(value), range.1.max(value));
    }
}

impl Default for Extremes {
    fn default() -> Self {
        let none = f64::MIN_POSITIVE;
        Self {
            deformation: none,
            deformation_rate: none,
            range: EMPTY,
            velocity: none,
            acceleration: none,
            force: none,
            visited: Visited {
                deformation: EMPTY,
                deformation_rate: EMPTY,
                motor_position: EMPTY,
                motor_velocity: EMPTY,
                input: EMPTY,
                reading: EMPTY,
            },
        }
    }
}

impl Extremes {
    fn take(&mut self, trace: &Trace) {
        let larger = |most: &mut f64, value: f64| {
            if value.is_finite() {
                *most = most.max(value.abs());
            }
        };
        for (motor, link) in trace.motor.iter().zip(&trace.link) {
            larger(&mut self.deformation, link[0] - motor[0]);
            larger(&mut self.deformation_rate, link[1] - motor[1]);
            larger(&mut self.velocity, link[1]);
            larger(&mut self.acceleration, link[2]);
            widen(&mut self.range, link[0]);
            let visited = &mut self.visited;
            widen(&mut visited.deformation, link[0] - motor[0]);
            widen(&mut visited.deformation_rate, link[1] - motor[1]);
            widen(&mut visited.motor_position, motor[0]);
            widen(&mut visited.motor_velocity, motor[1]);
        }
        let forces = trace.force.iter();
        forces.for_each(|force| larger(&mut self.force, *force));
    }
}

/// How large the motion is that a model of this kind, with these values of its keys, itself makes in
/// the first of the experiments.
pub fn scales(kind: &Kind, keys: &[f64], experiments: &[Experiment], model: &Model) -> Scales {
    let experiment = &experiments[0];
    let start = rung(kind, keys, experiment);
    let mut seen = Extremes::default();
    see_motion(kind, keys, &model.terms(), experiment, &start, |trace| {
        seen.take(trace)
    });
    let visited = visited(&seen, experiments);
    let deformation = seen.deformation;
    let linear = (kind.linear)(keys, experiment.input);
    let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let input = largest(&experiment.input_values);
    let span = experiment.span();
    let mode = kind.mode.map(|(f, xi)| (keys[f] * TAU, keys[xi]));
    let fastest = model.fastest();
    let fastest = if fastest > 1e-6 {
        fastest
    } else {
        TAU / (span.1 - span.0) * 10.0
    };
    let elastic = linear.stiffness * deformation / linear.unit_force;
    // Under a loop the input is a position: what drives is what the loop asks for.
    let driven = match linear.position_loop {
        // What holds the link in its motion was measured: any one law may make all of it.
        _ if linear.link_is_input => largest(&experiment.outputs[0].values),
        Some(_) => seen.force / linear.unit_force,
        None => linear.motor_gain.abs().max(linear.link_gain.abs()) * input / linear.unit_force,
    };
    let output = &experiment.outputs[0];
    let position = match seen.range {
        range if range.0 < range.1 => range,
        _ => (0.0, 1.0),
    };
    let velocity = seen.velocity;
    // Where nothing bends the same errors are held against the travel.
    let (deformation, deformation_rate) = match linear.link {
        Some(_) => (deformation, seen.deformation_rate),
        None => (RIGID * (position.1 - position.0), velocity),
    };
    Scales {
        deformation,
        deformation_rate,
        position,
        velocity,
        acceleration: seen.acceleration,
        force: match linear.motor {
            // Friction at the drive may take most of what drives, far more than the spring carries.
            MotorSide::Free { .. } => elastic.max(driven),
            _ if elastic > 0.0 && linear.link.is_some() && !linear.link_is_input => elastic,
            _ => driven,
        }
        .max(f64::MIN_POSITIVE),
        input: input.max(f64::MIN_POSITIVE),
        natural_frequency: mode.map_or(fastest, |mode| mode.0),
        damping_ratio: mode.map_or(0.05, |mode| mode.1),
        span: experiments.iter().map(Experiment::span).fold(span, joined),
        sample_time: (span.1 - span.0) / output.values.len().max(1) as f64,
        candidate_events: Vec::new(),
        candidate_frequencies: Vec::new(),
        candidate_orders: Vec::new(),
        candidate_stops: Vec::new(),
        forced: linear.motor == MotorSide::Fixed && !linear.link_is_input,
        tracked: output.channel == Role::TipPosition,
        rigid: linear.link.is_none(),
        visited,
    }
}

/// The least range that contains two.
fn joined(one: (f64, f64), other: (f64, f64)) -> (f64, f64) {
    (one.0.min(other.0), one.1.max(other.1))
}

/// The ranges that a motion visits, and those of what was recorded.
fn visited(seen: &Extremes, experiments: &[Experiment]) -> Visited {
    let mut visited = seen.visited;
    for experiment in experiments {
        let inputs = experiment.input_values.iter();
        inputs.for_each(|value| widen(&mut visited.input, *value));
        let readings = experiment.outputs[0].values.iter();
        readings.for_each(|value| widen(&mut visited.reading, *value));
    }
    visited
}

/// The best of several starts of the frequency, and whether the arm already rang at the start.
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

//! Sizes of a model's motion.

use super::range::{EMPTY, widen};
use quell_model::chain::MotorSide;
use quell_model::effects::{Scales, Visited};
use quell_model::{Departure, Experiment, Kind, Model, StartComponent, Trace, see_motion};
use quell_recording::Role;
use std::f64::consts::TAU;

/// Typical error of a rigid axis, as a share of its travel; it replaces the deformation.
const RIGID: f64 = 0.01;

/// A departure of the start that moves the link as much as its sensor does, if the motor side never moves: the
/// recording then shows free decay only.
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

/// The largest values of a motion; values that are not finite are ignored.
struct Extremes {
    deformation: f64,
    deformation_rate: f64,
    /// Range of the link's position.
    range: (f64, f64),
    velocity: f64,
    acceleration: f64,
    force: f64,
    visited: Visited,
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

/// Sizes of the motion that the model itself makes in the first experiment, with these values of its keys.
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
    // Under a loop the input is a position; the driving force is that of the loop.
    let driven = match linear.position_loop {
        // The force that holds the link in its motion was measured: a single law may be all of it.
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
    // Without an elastic joint errors are compared with the travel.
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
            // Friction at the drive may take most of the driving force, which is far more than the spring
            // carries.
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

/// The least range that contains two others.
fn joined(one: (f64, f64), other: (f64, f64)) -> (f64, f64) {
    (one.0.min(other.0), one.1.max(other.1))
}

/// The ranges that a motion visits, and those of the recorded signals.
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

//! The data behind a static law: the force that is missing without it, over its coordinate.
//!
//! With everything else as fitted, the residual `e` without the law obeys `e'' + 2 xi w e' + w^2 e = -F / m`. A
//! smoother estimates the force `F` from it; it is plotted over the coordinate that the explanation visits. For
//! a sensor law it is `e` itself. The shape of the law does not enter: these are the partial residuals of a
//! regression.
//!
//! Source: Larsen and McCleary, The use of partial residual plots in regression analysis, Technometrics 14 (1972).

use super::point::{EffectAt, Point};
use super::problem::Problem;
use quell_model::chain::MotorSide;
use quell_model::effects::{Coordinate, Place, Slot};
use quell_recording::Role;

/// Most points that are reported.
const MOST: usize = 400;

/// Ratio of a force's standard deviation to the least one above which the point is left out.
const UNKNOWN: f64 = 1.5;

/// A series at the stamps of the first output.
type Series = Vec<f64>;

/// Coordinate and force (for a sensor: its error) at stamps of the first output. Empty where the force does not
/// move the link of a prescribed motor side: a free motor side has its own damping and loop in between.
pub fn law_points(problem: &Problem, point: &Point, effect: EffectAt) -> Vec<[f64; 2]> {
    let seen = effect.0.slot().and_then(|slot| match slot {
        Slot::Sensor => error_over_reading(problem, point, effect),
        Slot::Spring | Slot::Friction | Slot::PositionForce | Slot::Hysteresis => {
            force_over(problem, point, effect, slot.coordinate())
        }
        _ => None,
    });
    let Some((along, values)) = seen else {
        return Vec::new();
    };
    let stride = values.len().div_ceil(MOST).max(1);
    let pairs = along.into_iter().zip(values).step_by(stride);
    let finite = |pair: &[f64; 2]| pair.iter().all(|value| value.is_finite());
    pairs.map(|(x, y)| [x, y]).filter(finite).collect()
}

fn error_over_reading(
    problem: &Problem,
    point: &Point,
    effect: EffectAt,
) -> Option<(Series, Series)> {
    let output = problem.experiments[0].outputs.first()?;
    Some((output.values.clone(), left_without(problem, point, effect)))
}

/// Residual of the first output without an effect; offsets and frame are those of the fit with it.
fn left_without(problem: &Problem, point: &Point, effect: EffectAt) -> Series {
    let without = problem.run(&point.without_effect(effect), 0).residuals;
    let with = problem.run(point, 0).residuals;
    let change = without[0]
        .iter()
        .zip(&with[0])
        .map(|(without, with)| without - with);
    let change: Series = change.collect();
    let left = problem.without_nuisances(0, with);
    left[0]
        .iter()
        .zip(change)
        .map(|(left, change)| left + change)
        .collect()
}

fn force_over(
    problem: &Problem,
    point: &Point,
    effect: EffectAt,
    coordinate: Coordinate,
) -> Option<(Series, Series)> {
    let experiment = problem.experiments.first()?;
    let linear = (problem.kind.linear)(&point.keys, experiment.input);
    let inertia = match (linear.motor, linear.link) {
        (MotorSide::Prescribed, Some((inertia, _))) if effect.1 != Place::Drive => inertia,
        _ => return None,
    };
    let output = experiment.outputs.first()?;
    if matches!(output.role, Role::LinkVelocity | Role::LinkAcceleration) {
        return None;
    }
    let left = left_without(problem, point, effect);
    let located = problem.locate_series(point, 0, &left);
    let [motor, link] = problem.kinematics(point, 0);
    // Near the ends of a recording the smoother is uncertain.
    let known = located.missing_std.iter().copied();
    let known = UNKNOWN * known.fold(f64::INFINITY, f64::min);
    let along = motor.iter().zip(&link).map(|(motor, link)| {
        let across = effect.1 == Place::Transmission;
        match coordinate {
            Coordinate::Deformation | Coordinate::Displacement => link[0] - motor[0],
            Coordinate::Speed if across => link[1] - motor[1],
            Coordinate::Speed => link[1],
            _ => link[0],
        }
    });
    let force = located.missing.iter().zip(&located.missing_std);
    let force = force.map(|(missing, std)| match *std <= known {
        true => -missing * inertia / linear.unit_force,
        false => f64::NAN,
    });
    Some((along.collect(), force.collect()))
}

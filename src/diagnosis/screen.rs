//! Screening: one simulation for each candidate and size, projected onto what the model cannot do.
//!
//! With `r` the residual of the refitted model and `d` its change by the effect, only the part `d_perp`
//! matters that no change of the model's own parameters makes. The effect at this size lowers the cost
//! by `-2 d_perp . r - |d_perp|^2`; at another size, were it linear, by `(d_perp . r)^2 / |d_perp|^2`,
//! of which a part is believed.

use super::fit::{Linearised, Projector, orthonormal};
use super::problem::{Point, Problem};
use crate::effects::{EFFECTS, Effect, Place};
use crate::recording::Role;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Share of the gain at another size that is believed: effects are not linear in their size.
const BELIEVED: f64 = 0.3;

/// An effect at a place with values to start from.
#[derive(Clone)]
pub struct Start {
    /// Which.
    pub effect: &'static Effect,
    /// Where.
    pub place: Place,
    /// Values.
    pub values: Vec<f64>,
    /// By how much the cost should fall.
    pub score: f64,
}

/// All effects that the model can lack, at their places.
pub fn candidates(problem: &Problem) -> Vec<(&'static Effect, Place)> {
    let experiment = &problem.experiments[0];
    let places = (problem.kind.places)(experiment.input);
    let own_clock = experiment.outputs.iter().all(|output| output.own_clock);
    let absolute = experiment
        .outputs
        .iter()
        .all(|output| output.role != Role::Deformation);
    let mut found = Vec::new();
    for effect in EFFECTS.iter().copied() {
        for &place in effect.places.iter().filter(|place| places.contains(place)) {
            // A delay of a sensor with a clock of its own is that clock's offset; one that measures
            // positions in space cannot scale the deformation and leave the motion as it is.
            let needless = own_clock && effect.name == "sensor_delay"
                || absolute && effect.name == "deformation_gain";
            if !needless {
                found.push((effect, place));
            }
        }
    }
    found
}

/// Scores every candidate at every size of its grid; best first, at most `each` sizes a candidate.
pub fn screen(
    problem: &Problem,
    point: &Point,
    linear: &Linearised,
    projector: &Projector,
    each: usize,
) -> Vec<Start> {
    let bases: Vec<DMatrix<f64>> = linear
        .jacobians
        .iter()
        .map(|jacobian| orthonormal(jacobian.clone()))
        .collect();
    let shared = basis(linear);
    let tried: Vec<Vec<Start>> = candidates(problem)
        .into_par_iter()
        .filter(|(effect, place)| {
            let twice =
                |term: &crate::model::Term| term.effect.name == effect.name && term.place == *place;
            !point.terms.iter().any(twice)
        })
        .map(|(effect, place)| {
            let mut starts: Vec<Start> = (effect.starts)(&problem.scales)
                .into_iter()
                .map(|values| {
                    let score = match linear.jacobians.len() {
                        1 => score(
                            problem, point, linear, projector, &bases[0], effect, place, &values,
                        ),
                        _ => stacked(
                            problem, point, linear, projector, &shared, effect, place, &values,
                        ),
                    };
                    Start {
                        effect,
                        place,
                        values,
                        score,
                    }
                })
                .collect();
            starts.sort_by(|a, b| b.score.total_cmp(&a.score));
            starts.truncate(each);
            starts
        })
        .collect();
    let mut all: Vec<Start> = tried.into_iter().flatten().collect();
    all.sort_by(|a, b| b.score.total_cmp(&a.score));
    all
}

/// Basis of all directions that the model has, over the stacked rows of all experiments.
fn basis(linear: &Linearised) -> DMatrix<f64> {
    if linear.jacobians.len() == 1 {
        return DMatrix::zeros(0, 0);
    }
    let shared = linear.globals.len();
    let rows: usize = linear.jacobians.iter().map(|j| j.nrows()).sum();
    let own: usize = linear.jacobians.iter().map(|j| j.ncols() - shared).sum();
    let mut stacked = DMatrix::zeros(rows, shared + own);
    let (mut row, mut column) = (0, shared);
    for jacobian in &linear.jacobians {
        let (n, m) = jacobian.shape();
        stacked
            .view_mut((row, 0), (n, shared))
            .copy_from(&jacobian.columns(0, shared));
        stacked
            .view_mut((row, column), (n, m - shared))
            .copy_from(&jacobian.columns(shared, m - shared));
        (row, column) = (row + n, column + m - shared);
    }
    orthonormal(stacked)
}

fn change(
    problem: &Problem,
    point: &Point,
    linear: &Linearised,
    projector: &Projector,
    experiment: usize,
) -> DVector<f64> {
    let moved = problem.residuals(point, experiment);
    projector.remove(experiment, &moved) - &linear.residuals[experiment]
}

#[allow(clippy::too_many_arguments)]
fn score(
    problem: &Problem,
    point: &Point,
    linear: &Linearised,
    projector: &Projector,
    basis: &DMatrix<f64>,
    effect: &'static Effect,
    place: Place,
    values: &[f64],
) -> f64 {
    let moved = point.with(effect, place, values.to_vec());
    let mut d = change(problem, &moved, linear, projector, 0);
    d -= basis * basis.tr_mul(&d);
    gain(d.dot(&linear.residuals[0]), d.norm_squared())
}

#[allow(clippy::too_many_arguments)]
fn stacked(
    problem: &Problem,
    point: &Point,
    linear: &Linearised,
    projector: &Projector,
    basis: &DMatrix<f64>,
    effect: &'static Effect,
    place: Place,
    values: &[f64],
) -> f64 {
    let moved = point.with(effect, place, values.to_vec());
    let (mut d, mut r) = (Vec::new(), Vec::new());
    for experiment in 0..problem.experiments.len() {
        d.extend_from_slice(change(problem, &moved, linear, projector, experiment).as_slice());
        r.extend_from_slice(linear.residuals[experiment].as_slice());
    }
    let mut d = DVector::from_vec(d);
    d -= basis * basis.tr_mul(&d);
    gain(d.dot(&DVector::from_vec(r)), d.norm_squared())
}

/// What a change with this product and square promises.
fn gain(product: f64, square: f64) -> f64 {
    if !(square.is_finite() && product.is_finite()) || square <= 0.0 {
        return f64::NEG_INFINITY;
    }
    let here = -2.0 * product - square;
    let elsewhere = match product < 0.0 {
        true => BELIEVED * product * product / square,
        false => 0.0,
    };
    here.max(elsewhere)
}

//! Fitted and held-out rows of a problem, and their derivatives.

use super::judge::Judge;
use super::point::{Global, Point};
use super::problem::Problem;
use super::projector::{Projector, orthonormal};
use super::rounding_at_rest::RoundingCovariance;
use nalgebra::{DMatrix, DVector};

/// Step of a derivative, relative to the reach of the unknown.
const STEP: f64 = 1e-3;

/// Fitted rows of all experiments, and held-out rows.
pub type Both = [DVector<f64>; 2];

/// Rows at points around a fit.
pub struct Views<'a> {
    judge: &'a Judge<'a>,
    problem: &'a Problem<'a>,
    projector: &'a Projector,
    apart: Option<Apart<'a>>,
    /// Whitening of the held-out rows of an experiment.
    rounding: Vec<RoundingCovariance>,
}

/// Recordings kept apart, in the problem of the judged explanation.
struct Apart<'a> {
    problem: Problem<'a>,
    projector: Projector,
    point: Point,
    /// Directions of these recordings' own unknowns, which are free.
    nuisances: Vec<DMatrix<f64>>,
}

impl<'a> Views<'a> {
    /// Views around a fitted point.
    pub fn new(
        judge: &'a Judge<'a>,
        problem: &'a Problem<'a>,
        projector: &'a Projector,
        point: &Point,
    ) -> Self {
        let apart = || {
            let (problem, own) = judge.apart(problem, point);
            let projector = Projector::new(&problem);
            let nuisances = problem.linearise(&own.point, &projector).jacobians;
            Apart {
                problem,
                projector,
                point: own.point,
                nuisances: nuisances.into_iter().map(orthonormal).collect(),
            }
        };
        let covariance = |e: usize| RoundingCovariance::new(problem, e, &judge.data.held_out[e]);
        Self {
            apart: (!judge.data.apart.is_empty()).then(apart),
            rounding: (0..problem.experiments.len()).map(covariance).collect(),
            judge,
            problem,
            projector,
        }
    }

    /// Whitened rows at a point. Nuisances are projected out of the fitted rows; the held-out rows take theirs
    /// from these.
    pub fn see(&self, point: &Point) -> Both {
        let (mut fitted, mut held) = (Vec::new(), Vec::new());
        for e in 0..self.problem.experiments.len() {
            let raw = self.problem.run(point, e).residuals;
            let rows = self.projector.remove(e, &self.problem.complete(e, &raw));
            fitted.extend(rows.iter().copied());
            if self.apart.is_none() {
                let first = held.len();
                self.judge.push_held_out(self.problem, e, raw, &mut held);
                self.rounding[e].whiten(&mut held[first..]);
            }
        }
        if let Some(apart) = &self.apart {
            held = apart.see(point);
        }
        for row in &mut held {
            *row = if row.is_finite() {
                row.clamp(-1e12, 1e12)
            } else {
                1e12
            };
        }
        [fitted, held].map(DVector::from_vec)
    }

    /// Derivatives by all unknowns, the shared ones first, then those of each recording, at a point with the
    /// rows `here`.
    pub fn slopes(&self, point: &Point, here: &Both) -> [DMatrix<f64>; 2] {
        let globals = self.problem.globals(point);
        let mut columns: Vec<Both> = globals
            .iter()
            .map(|&global| {
                let step = STEP * self.problem.reach(point, global);
                let (moved, change) = nudged(self.problem, point, global, step);
                self.slope(here, &moved, change)
            })
            .collect();
        columns.extend(self.local_slopes(point, &globals, here));
        joined(&columns, here)
    }

    fn local_slopes(&self, point: &Point, globals: &[Global], here: &Both) -> Vec<Both> {
        let problem = self.problem;
        let windows = problem.experiments.iter().any(|e| !e.windows.is_empty());
        if self.apart.is_some() || windows {
            // A fitted recording's own unknowns do not affect held-out rows.
            let all = problem.linearise(point, self.projector).stacked();
            let own = all.columns_range(globals.len()..);
            let both = own
                .column_iter()
                .map(|column| [column.into_owned(), DVector::zeros(here[1].len())]);
            return both.collect();
        }
        let mut way = DVector::zeros(problem.unknowns(point, globals));
        let sizes = local_sizes(problem, point, globals).into_iter().enumerate();
        let column = |(k, size): (usize, f64)| {
            way.fill(0.0);
            way[globals.len() + k] = -STEP * size;
            self.slope(here, &problem.stepped(point, globals, &way), STEP * size)
        };
        sizes.map(column).collect()
    }

    /// Derivative along a change of a point.
    pub fn slope(&self, here: &Both, moved: &Point, change: f64) -> Both {
        if change == 0.0 {
            return [0, 1].map(|k| DVector::zeros(here[k].len()));
        }
        let there = self.see(moved);
        [0, 1].map(|k| (&there[k] - &here[k]) / change)
    }
}

impl Apart<'_> {
    fn see(&self, point: &Point) -> Vec<f64> {
        let mut own = self.point.clone();
        own.keys.clone_from(&point.keys);
        own.terms.clone_from(&point.terms);
        own.given_terms = own.terms.len();
        own.inertias[..point.inertias.len()].copy_from_slice(&point.inertias);
        let rows = self.problem.evaluate(&own, &self.projector).residuals;
        let free = |(rows, own): (&DVector<f64>, &DMatrix<f64>)| rows - own * own.tr_mul(rows);
        let parts: Vec<DVector<f64>> = rows.iter().zip(&self.nuisances).map(free).collect();
        parts.iter().flat_map(|rows| rows.iter().copied()).collect()
    }
}

/// Columns as two matrices, of fitted and of held-out rows.
pub fn joined(columns: &[Both], here: &Both) -> [DMatrix<f64>; 2] {
    [0, 1].map(|k| {
        let own: Vec<_> = columns.iter().map(|both| both[k].column(0)).collect();
        match own.is_empty() {
            true => DMatrix::zeros(here[k].len(), 0),
            false => DMatrix::from_columns(&own),
        }
    })
}

/// Typical sizes of the recordings' own unknowns.
pub fn local_sizes(problem: &Problem, point: &Point, globals: &[Global]) -> Vec<f64> {
    let of = |e: usize| {
        let sizes = problem.sizes(point, globals, e);
        sizes
            .iter()
            .skip(globals.len())
            .copied()
            .collect::<Vec<_>>()
    };
    (0..problem.experiments.len()).flat_map(of).collect()
}

/// The point with a shared unknown moved away from a bound, and the size of the move.
fn nudged(problem: &Problem, point: &Point, global: Global, step: f64) -> (Point, f64) {
    let here = problem.get(point, global);
    let moved = |step: f64| {
        let mut moved = point.clone();
        problem.set(&mut moved, global, here + step);
        let change = problem.get(&moved, global) - here;
        (moved, change)
    };
    let forward = moved(step);
    match forward.1.abs() >= 0.5 * step {
        true => forward,
        false => moved(-step),
    }
}

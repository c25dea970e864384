//! The data against which explanations are judged: fitted rows, held-out rows, and recordings kept apart.

use super::baseline;
use super::data::Data;
use super::fit::Fitted;
use super::point::Point;
use super::problem::{Problem, Responses, Rows};
use super::projector::Projector;
use super::split;
use super::start::ringing;
use nalgebra::DVector;
use quell_model::{Model, StartComponent};
use quell_signal::SingularValues;
use std::sync::Arc;

/// Most steps of the fit of starts, clocks and frames of a recording kept apart. Three are usually enough;
/// windows in which friction sticks need more.
const APART: usize = 30;

/// Judges fits of one problem.
pub struct Judge<'a> {
    /// The model as it was given.
    pub model: &'a Model,
    /// The recordings.
    pub data: &'a Data,
    /// Number of fitted rows.
    pub train_rows: usize,
    /// Number of held-out rows.
    pub held_out_rows: usize,
    /// Components of the start that are free in the recordings kept apart; `None` until that is decided.
    starts: Option<Vec<StartComponent>>,
    /// Responses of the recordings kept apart to rounding at rest.
    pub rounding_apart: Arc<Vec<Responses>>,
}

impl<'a> Judge<'a> {
    /// For a problem over the data's experiments and the refitted model.
    pub fn new(model: &'a Model, data: &'a Data, problem: &Problem, refitted: &Point) -> Self {
        let count = |rows: &[Vec<Rows>]| -> usize {
            let ranges = rows.iter().flatten().flatten();
            ranges.map(|range| range.len()).sum()
        };
        let apart: usize = data.apart.iter().map(|e| e.samples()).sum();
        let mut judge = Self {
            model,
            data,
            train_rows: count(&problem.rows),
            held_out_rows: count(&data.held_out) + apart,
            starts: None,
            rounding_apart: Arc::default(),
        };
        if !data.apart.is_empty() {
            let (mut apart, still) = judge.apart(problem, refitted);
            let projector = Projector::new(&apart);
            let still = ringing(&mut apart, still, &projector).point;
            judge.rounding_apart = Arc::new(apart.responses_to_rounding(&still));
            judge.starts = Some(apart.departures);
        }
        judge
    }

    /// Sets the rounding at rest of the recordings kept apart from a better model.
    pub fn round_again(&mut self, problem: &Problem, point: &Point) {
        if self.data.apart.is_empty() {
            return;
        }
        let (apart, fitted) = self.apart(problem, point);
        self.rounding_apart = Arc::new(apart.responses_to_rounding(&fitted.point));
    }

    /// Appends the whitened residuals of the held-out rows of a recording. Clock, offset and frame are those of
    /// its fitted rows.
    pub fn push_held_out(
        &self,
        problem: &Problem,
        e: usize,
        raw: Vec<Vec<f64>>,
        rows: &mut Vec<f64>,
    ) {
        let residual = problem.without_nuisances(e, raw);
        for (k, ranges) in self.data.held_out[e].iter().enumerate() {
            for range in ranges {
                problem.whitening[e][k].apply(&residual[k][range.clone()], rows);
            }
        }
    }

    /// The whole recordings kept apart, with their own clocks, offsets and frames fitted. A sensor has the same
    /// noise as in the fitted recordings.
    pub fn apart(&self, fitted: &Problem, point: &Point) -> (Problem<'a>, Fitted) {
        let rows = self.data.apart.iter().map(split::whole).collect();
        let mut problem = baseline::problem(self.model, &self.data.apart, rows);
        problem.freeze();
        problem.rounding_at_rest = self.rounding_apart.clone();
        if let Some(starts) = &self.starts {
            problem.departures.clone_from(starts);
        }
        // A payload of the fitted recordings has a known inertia; another payload has not.
        let carried = baseline::payloads(&self.data.experiments);
        problem.free_payloads = carried.len()..carried.len();
        for payload in std::mem::replace(&mut problem.payloads, carried) {
            if !problem.payloads.contains(&payload) {
                problem.payloads.push(payload);
            }
        }
        problem.free_payloads.end = problem.payloads.len();
        let known = &fitted.experiments[0].outputs;
        for (e, experiment) in self.data.apart.iter().enumerate() {
            for (k, output) in experiment.outputs.iter().enumerate() {
                let same = known.iter().position(|own| own.channel == output.channel);
                if let Some(own) = same {
                    problem.noise[e][k] = fitted.noise[0][own].clone();
                    problem.whitening[e][k] = fitted.whitening[0][own].clone();
                }
            }
        }
        let mut start = problem.start(self.model);
        start.keys.clone_from(&point.keys);
        start.inertias[..point.inertias.len()].copy_from_slice(&point.inertias);
        start.terms.clone_from(&point.terms);
        start.given_terms = start.terms.len();
        let projector = Projector::new(&problem);
        let fitted = problem.fit(&start, &projector, APART);
        (problem, fitted)
    }
}

impl Problem<'_> {
    /// Recorded minus predicted over a whole experiment, without the linear nuisances of the fitted rows.
    pub fn explained(&self, point: &Point, e: usize) -> Vec<Vec<f64>> {
        self.without_nuisances(e, self.run(point, e).residuals)
    }

    /// Residuals of a whole experiment without the linear nuisances of its fitted rows.
    pub fn without_nuisances(&self, e: usize, mut raw: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let coefficients = self.coefficients(e, &self.complete(e, &raw));
        let mut next = coefficients.iter();
        for (output, residual) in self.experiments[e].outputs.iter().zip(&mut raw) {
            for column in &output.columns {
                let c = next.next().copied().unwrap_or(0.0);
                for (r, b) in residual.iter_mut().zip(column) {
                    *r -= c * b;
                }
            }
        }
        raw
    }

    /// Coefficients of the linear nuisances of one experiment, output by output.
    pub fn coefficients(&self, e: usize, rows: &DVector<f64>) -> Vec<f64> {
        let factors = SingularValues::of(&self.linear(e));
        factors.map_or_else(Vec::new, |own| own.solve(rows, 1e-10).data.into())
    }
}

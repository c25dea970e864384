//! An explanation: a structure, fitted, and how it does on what was held out.

use super::baseline::{self, Data};
use super::evidence::Evidence;
use super::fit::{Fitted, Projector};
use super::left::rounded;
use super::point::{EffectAt, Point};
use super::problem::{Problem, Rows};
use super::split;
use super::start::ringing;
use super::thresholds::FLOOR;
use super::views::Views;
use nalgebra::DVector;
use quell_model::{Model, StartComponent};

/// Most steps in which the starts, clocks and frames of a recording kept apart are found. Mostly three do;
/// windows in which friction sticks take more.
const APART: usize = 30;

/// A fitted structure and its figures.
#[derive(Clone)]
pub struct Explanation {
    /// Where the fit ended.
    pub fitted: Fitted,
    /// Sum of squares of the whitened residual on the fitted rows.
    pub train: f64,
    /// The same on the held-out rows.
    pub held_out: f64,
    /// Its marginal likelihood.
    pub evidence: Evidence,
    /// Whether a parameter of its effects lies at the end of its range.
    pub is_at_end: bool,
}

impl Explanation {
    /// The effects that were added to the model, at their places.
    pub fn effects(&self) -> Vec<EffectAt> {
        self.fitted.point.effects()
    }

    /// Number of terms that were added to the model: an event may have several.
    pub fn terms(&self) -> usize {
        self.fitted.point.terms.len() - self.fitted.point.given_terms
    }

    /// Whether one of its laws was learned.
    pub fn is_learned(&self) -> bool {
        let point = &self.fitted.point;
        let mut added = point.terms[point.given_terms..].iter();
        added.any(|term| term.effect.is_learned())
    }

    /// Whether another one has the same effects at the same places, as often, in whatever order.
    pub fn is_like(&self, other: &Self) -> bool {
        self.has_structure_of(&other.fitted.point)
    }

    /// Whether a point has the same effects at the same places, as often, in whatever order.
    pub fn has_structure_of(&self, other: &Point) -> bool {
        self.fitted.point.structure() == other.structure()
    }

    /// Log of its marginal likelihood.
    pub fn log_evidence(&self, temperature: f64) -> f64 {
        self.evidence.log(temperature)
    }
}

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
    /// Sums of the squared lengths of rests in which a sensor rounds, of whole recordings and of held-out rows.
    pub rounded: [f64; 2],
    /// Components of the start that are free in the recordings kept apart, once that is decided.
    starts: Option<Vec<StartComponent>>,
}

impl<'a> Judge<'a> {
    /// For a problem over the data's experiments and the refitted model.
    pub fn new(model: &'a Model, data: &'a Data, problem: &Problem, refitted: &Point) -> Self {
        let count = |rows: &[Vec<Rows>]| -> usize {
            let ranges = rows.iter().flatten().flatten();
            ranges.map(|range| range.len()).sum()
        };
        let apart: usize = data.apart.iter().map(|e| e.samples()).sum();
        let whole: Vec<_> = data.experiments.iter().map(split::whole).collect();
        let mut judge = Self {
            model,
            data,
            train_rows: count(&problem.rows),
            held_out_rows: count(&data.held_out) + apart,
            rounded: [&whole, &data.held_out].map(|rows| rounded(&data.experiments, rows)),
            starts: None,
        };
        if !data.apart.is_empty() {
            let (mut apart, still) = judge.apart(problem, refitted);
            let projector = Projector::new(&apart);
            ringing(&mut apart, still, &projector);
            judge.starts = Some(apart.departures);
        }
        judge
    }

    /// Chi-squared per row, at least 1: what the best model leaves is the unit of evidence.
    pub fn unit(&self, explanation: &Explanation) -> f64 {
        (explanation.train / self.train_rows.max(1) as f64).max(1.0)
    }

    /// A fit with its figures.
    pub fn judge(&self, problem: &Problem, projector: &Projector, fitted: Fitted) -> Explanation {
        let train = fitted.cost - problem.disbelief(&fitted.point);
        let views = Views::new(self, problem, projector, &fitted.point);
        // Where only noise is left, no other shape would leave less.
        let shaped = train > self.train_rows as f64 * FLOOR;
        let evidence = Evidence::new(problem, &views, &fitted, shaped);
        Explanation {
            train,
            held_out: evidence.held_out(),
            is_at_end: problem.is_at_end(&fitted),
            fitted,
            evidence,
        }
    }

    /// Appends the whitened residuals on the held-out rows of a recording of which others were fitted. Clock,
    /// offset and frame are those of the fitted rows.
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

    /// The whole of recordings kept apart, their own clocks, offsets and frames fitted. A sensor has the
    /// noise that it has in what was fitted.
    pub fn apart(&self, fitted: &Problem, point: &Point) -> (Problem<'a>, Fitted) {
        let rows = self.data.apart.iter().map(split::whole).collect();
        let mut problem = baseline::problem(self.model, &self.data.apart, rows);
        problem.freeze();
        if let Some(starts) = &self.starts {
            problem.departures.clone_from(starts);
        }
        // A payload that was carried in the fitted recordings is known; another one is not.
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
    /// Recorded minus predicted over a whole experiment, the linear nuisances of the fitted rows taken
    /// out.
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

    /// Coefficients of the linear nuisances of one experiment.
    fn coefficients(&self, e: usize, rows: &DVector<f64>) -> Vec<f64> {
        let columns = self.linear(e);
        if columns.ncols() == 0 {
            return Vec::new();
        }
        let solved = columns.svd(true, true).solve(rows, 1e-10);
        solved.map_or_else(|_| Vec::new(), |c| c.iter().copied().collect())
    }
}

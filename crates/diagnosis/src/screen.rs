//! Screening: one simulation for each candidate and size, projected onto what the model itself cannot produce.
//!
//! Let `r` be the residual of the refitted model and `d` its change by the effect. Only the part `d_perp`
//! counts that no change of the model's own parameters produces. At this size the effect lowers the cost by `-2
//! d_perp . r - |d_perp|^2`. At another size a linear effect would lower it by `(d_perp . r)^2 / |d_perp|^2`,
//! of which a part is believed. If the model's own parameters produce most of `d` (a spring that stiffens first
//! shifts the frequency), the effect is simulated a second time with these parameters moved against it. The
//! second-order rest of a large shift would otherwise hide it.

mod learned;

use super::fit::Linearised;
use super::point::{EffectAt, Point};
use super::problem::Problem;
use super::projector::{Projector, orthonormal};
use super::run_of::Run;
use nalgebra::{Complex, DMatrix, DVector};
use quell_model::Term;
use quell_model::effects::{Effect, LEARNED, Law, Place, Scales, Slot};
use quell_recording::Role;
use quell_signal::SingularValues;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Share of the gain at another size that is believed, since effects are not linear in their size.
const BELIEVED: f64 = 0.3;

/// Ratio of the squares of a change's own part and of the rest from which the rest may be the second order of
/// the own part: a frequency shift of a tenth leaves about a tenth of itself.
const MOSTLY_OWN: f64 = 10.0;
/// Share of the mismatch from which a gain is promising.
const HOPEFUL: f64 = 0.5;

/// An effect with values to start from.
#[derive(Clone)]
pub struct Start {
    /// The effect, its place and its values.
    pub term: Term,
    /// Expected fall of the cost.
    pub score: f64,
    /// Factor on the size at which it is tried again.
    factor: Factor,
}

/// Factor on a size at which it is tried again.
#[derive(Clone, Copy, PartialEq)]
enum Factor {
    /// The change is larger than the residual, and so not linear in the size: the ratio of their lengths.
    Smaller(f64),
    /// The cost would be least there if the effect were linear in its size.
    Linear(f64),
    /// There is none.
    None,
}

/// All effects of a table that the model can lack, at their places. Two effects that are the same law, since
/// the places are between the same bodies, count once.
pub fn candidates(problem: &Problem, table: Table) -> Vec<EffectAt> {
    let experiment = &problem.experiments[0];
    let (places, linear) = problem.places();
    let own_clock = experiment.outputs.iter().all(|output| output.own_clock);
    let mut found: Vec<EffectAt> = Vec::new();
    for &effect in table.effects(problem) {
        for &place in effect.places.iter().filter(|place| places.contains(place)) {
            let one = |other: &EffectAt| {
                let attached = linear.attachment(other.1) == linear.attachment(place);
                attached && is_one_force(other.0, effect)
            };
            if !(own_clock && effect.shifts_stamps() || found.iter().any(one)) {
                found.push((effect, place));
            }
        }
    }
    found
}

/// Whether two effects are the same force if they act between the same bodies.
fn is_one_force(one: &Effect, other: &Effect) -> bool {
    let force = matches!((one.law)(&one.neutral()), Law::Force(_) | Law::Friction(_));
    let over_position = |own: &Effect| {
        let slot = own.slot().filter(|_| own.is_learned());
        matches!(slot, Some(Slot::Spring | Slot::PositionForce))
    };
    force && one == other || over_position(one) && over_position(other)
}

/// Where candidates come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// The catalogue.
    Named,
    /// Laws whose shape is learned.
    Learned,
}

impl Table {
    fn effects(self, problem: &Problem) -> &'static [&'static Effect] {
        match self {
            Self::Named => problem.catalogue.0,
            Self::Learned => LEARNED,
        }
    }
}

/// The data against which the candidates are screened.
pub struct Screen<'a> {
    problem: &'a Problem<'a>,
    point: &'a Point,
    linear: &'a Linearised,
    projector: &'a Projector,
    /// Basis of all directions of the model's own unknowns.
    basis: DMatrix<f64>,
    /// Residual of the refitted model, all experiments.
    residual: DVector<f64>,
    /// Maps rows to the least-squares step of the model's own unknowns.
    steps: DMatrix<f64>,
}

/// Scores every candidate at every size of its grid, the best first, with at most `each` sizes for a candidate.
pub fn screen(
    problem: &Problem,
    point: &Point,
    linear: &Linearised,
    projector: &Projector,
    (table, each): (Table, usize),
) -> Vec<Start> {
    Screen::new(problem, point, linear, projector).scored(table, each)
}

impl Start {
    /// The effect with a factor on its size, within its bounds.
    pub fn resized(&self, problem: &Problem, factor: f64) -> Term {
        let mut term = self.term.clone();
        let size = term.effect.size();
        let (low, high) = (term.effect.parameters[size].bounds)(&problem.scales);
        term.values[size] = (term.values[size] * factor).clamp(low, high);
        term
    }
}

impl<'a> Screen<'a> {
    /// The data at a point with its linearisation.
    pub fn new(
        problem: &'a Problem<'a>,
        point: &'a Point,
        linear: &'a Linearised,
        projector: &'a Projector,
    ) -> Self {
        let directions = linear.stacked();
        Self {
            problem,
            point,
            linear,
            projector,
            steps: steps(&directions),
            basis: orthonormal(directions),
            residual: stacked(&linear.residuals),
        }
    }

    /// See [`screen`].
    pub fn scored(&self, table: Table, each: usize) -> Vec<Start> {
        let tried = candidates(self.problem, table)
            .into_par_iter()
            .filter(|effect| self.point.has_room_for(*effect) && !self.problem.is_cut());
        let mut all: Vec<Start> = match table {
            Table::Named => tried
                .flat_map_iter(|(effect, place)| self.sizes(effect, place, each))
                .collect(),
            Table::Learned => self.told_apart(
                tried
                    .flat_map_iter(|(effect, place)| self.curves(effect, place))
                    .collect(),
            ),
        };
        all.sort_by(|a, b| b.score.total_cmp(&a.score));
        all
    }

    /// Residual at the point.
    pub fn residual(&self) -> &DVector<f64> {
        &self.residual
    }

    /// The part of the change by the last effect of a point that the model itself cannot produce.
    pub fn own_change(&self, moved: &Point) -> DVector<f64> {
        self.without_own(self.changed(moved))
    }

    /// The part of a change that the model itself cannot produce.
    fn without_own(&self, mut change: DVector<f64>) -> DVector<f64> {
        change -= &self.basis * self.basis.tr_mul(&change);
        change
    }

    /// Change of the residual by the last effect of a point.
    fn changed(&self, moved: &Point) -> DVector<f64> {
        let last = moved.terms.len() - 1;
        let again = |e: usize| {
            let before = &self.linear.runs[e];
            self.problem.run_again(moved, e, last, before)
        };
        self.change(again)
    }

    /// An effect at its place with the values of its grid, a learned law with the range of that place. What happened in a
    /// recording has a grid for each. Where there is an accelerometer, which shows them most, a law is tried with and
    /// without the parameters that it may be without, else without them.
    fn starts(&self, effect: &'static Effect, place: Place) -> Vec<Term> {
        let problem = self.problem;
        let outputs = problem.experiments.iter().flat_map(|own| &own.outputs);
        let are_seen = outputs.map(|own| own.role).any(Role::is_acceleration);
        let laws = |values: Vec<f64>| match effect.simpler(&values) {
            Some(simpler) if are_seen => vec![simpler, values],
            Some(simpler) => vec![simpler],
            None => vec![values],
        };
        let of = |scales: &Scales, recording: Option<usize>| -> Vec<Term> {
            let term = |values| Term::new(effect, place, values).in_recording(recording);
            effect
                .starts_at(place, scales)
                .into_iter()
                .flat_map(laws)
                .map(term)
                .collect()
        };
        match effect.happens() {
            true => {
                let each = problem.scales_of_each.iter();
                each.flat_map(|(own, scales)| of(scales, Some(*own)))
                    .collect()
            }
            false => of(&problem.scales, None),
        }
    }

    /// The best sizes of one candidate.
    pub fn sizes(&self, effect: &'static Effect, place: Place, each: usize) -> Vec<Start> {
        let start = |term: Term| {
            let (score, factor) = self.score(&self.point.with(term.clone()));
            Start {
                term,
                score,
                factor,
            }
        };
        let grid = self.starts(effect, place);
        let mut starts: Vec<Start> = grid.into_iter().map(start).collect();
        starts.sort_by(|a, b| b.score.total_cmp(&a.score));
        starts.truncate(each);
        // At a bound of the size the factor is arbitrary. A resized start is used only if its score is better.
        // A size is reduced before it is tried at the optimum of a linear effect.
        for reduces in [true, false] {
            for own in &mut starts {
                let factor = match own.factor {
                    Factor::Smaller(factor) if reduces => factor,
                    Factor::Linear(factor) if !reduces => factor,
                    _ => continue,
                };
                let resized = start(own.resized(self.problem, factor));
                if resized.score > own.score {
                    *own = resized;
                }
            }
        }
        starts.sort_by(|a, b| b.score.total_cmp(&a.score));
        starts
    }

    /// Expected gain of a candidate, and the factor of its size.
    fn score(&self, moved: &Point) -> (f64, Factor) {
        let change = self.changed(moved);
        let own = self.basis.tr_mul(&change).norm_squared();
        let plain = self.promise(change.clone());
        let hopeful = plain.gain > HOPEFUL * self.residual.norm_squared();
        if own < MOSTLY_OWN * plain.square || hopeful {
            return (plain.gain, plain.factor);
        }
        let step = &self.steps * (&change + &self.residual);
        let globals = &self.linear.globals;
        if step.len() != self.problem.unknowns(moved, globals) {
            return (plain.gain, plain.factor);
        }
        let compensated = self.problem.moved(moved, globals, &step);
        let other = self.promise(self.change(|e| self.problem.run(&compensated, e)));
        match other.gain > plain.gain {
            true => (other.gain, other.factor),
            false => (plain.gain, plain.factor),
        }
    }

    /// Change of the residual of all experiments.
    fn change(&self, run: impl Fn(usize) -> Run) -> DVector<f64> {
        let rows = |e: usize| {
            let rows = self.problem.complete(e, &run(e).residuals);
            self.projector.remove(e, &rows)
        };
        let rows: Vec<DVector<f64>> = (0..self.linear.residuals.len()).map(rows).collect();
        stacked(&rows) - &self.residual
    }

    /// Expected gain of a change.
    fn promise(&self, change: DVector<f64>) -> Promise {
        let change = self.without_own(change);
        let (product, square) = (change.dot(&self.residual), change.norm_squared());
        let gain = gain(product, square);
        let ratio = self.residual.norm_squared() / square;
        let factor = match gain.is_finite() {
            true if product < 0.0 => Factor::Linear(-product / square),
            true if ratio < 1.0 => Factor::Smaller(ratio.sqrt()),
            _ => Factor::None,
        };
        Promise {
            gain,
            square,
            factor,
        }
    }
}

/// Expected gain of the part of a change that the model itself cannot produce.
struct Promise {
    /// Expected fall of the cost.
    gain: f64,
    /// Squared length of that part.
    square: f64,
    /// Factor on the size at which it is tried again.
    factor: Factor,
}

fn stacked(rows: &[DVector<f64>]) -> DVector<f64> {
    let all = rows.iter().flat_map(|part| part.iter().copied());
    DVector::from_iterator(rows.iter().map(|part| part.len()).sum(), all)
}

/// The pseudo-inverse of the directions from their normal equations.
fn steps(directions: &DMatrix<f64>) -> DMatrix<f64> {
    let norms: Vec<f64> = directions.column_iter().map(|c| c.norm()).collect();
    let scale = |k: usize| if norms[k] > 0.0 { 1.0 / norms[k] } else { 1.0 };
    let mut scaled = directions.clone();
    for (k, mut column) in scaled.column_iter_mut().enumerate() {
        column *= scale(k);
    }
    let product = scaled.tr_mul(&scaled);
    // Linearly dependent directions share a step.
    let mut steps = match SingularValues::of(&product) {
        None => DMatrix::zeros(directions.ncols(), directions.nrows()),
        Some(own) => own.pseudo_inverse(1e-9) * scaled.transpose(),
    };
    for (k, mut row) in steps.row_iter_mut().enumerate() {
        row *= scale(k);
    }
    steps
}

/// Angular frequencies at which a residual has its three highest peaks, the highest first.
///
/// The line of a mode that hardly decays is as wide as the recording's resolution. The frequency step is a
/// quarter of `1 / T`, so that a start lies in the basin of the right minimum.
pub fn peaks(time: &[f64], residual: &[f64]) -> Vec<f64> {
    let n = residual.len().min(MOST_SAMPLES);
    if n < 16 {
        return Vec::new();
    }
    let mean = residual[..n].iter().sum::<f64>() / n as f64;
    let step = TAU / (4.0 * n as f64);
    let power = |k: usize| {
        let turn = Complex::from_polar(1.0, -step * k as f64);
        let mut phase = Complex::new(1.0, 0.0);
        let mut sum = Complex::new(0.0, 0.0);
        for (i, value) in residual[..n].iter().enumerate() {
            // A window against the ends of the record, whose jump would add power at every frequency.
            let window = 1.0 - (TAU * i as f64 / n as f64).cos();
            sum += phase * (window * (value - mean));
            phase *= turn;
        }
        sum.norm_sqr()
    };
    let powers: Vec<f64> = (0..2 * n).into_par_iter().map(power).collect();
    let is_peak = |k: &usize| powers[*k] > powers[k - 1] && powers[*k] >= powers[k + 1];
    let mut found: Vec<usize> = (8..2 * n - 1).filter(is_peak).collect();
    found.sort_by(|a, b| powers[*b].total_cmp(&powers[*a]));
    let rate = (n - 1) as f64 / (time[n - 1] - time[0]);
    found
        .iter()
        .take(3)
        .map(|&k| step * k as f64 * rate)
        .collect()
}

/// Most samples in which peaks are searched: the cost grows with the square of their number.
const MOST_SAMPLES: usize = 4096;

/// Squared change of all rows together, in units of the noise, below which a size has no visible effect. For
/// example, the response of a prescribed motor side to a force is rounding only, of arbitrary direction.
const UNSEEN: f64 = 1e-4;

/// Expected gain of a change with this product and square.
fn gain(product: f64, square: f64) -> f64 {
    if !(square.is_finite() && product.is_finite()) || square <= UNSEEN {
        return f64::NEG_INFINITY;
    }
    let here = -2.0 * product - square;
    let elsewhere = match product < 0.0 {
        true => BELIEVED * product * product / square,
        false => 0.0,
    };
    here.max(elsewhere)
}

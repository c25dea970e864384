//! Confidence intervals by a parametric bootstrap: the scatter of the fit over other draws of the noise.
//!
//! A replicate takes the best explanation for the truth. Its outputs are the prediction for the recorded input,
//! plus noise ([`output_noise`]). Its input is the recorded one plus another draw of the encoder's rounding
//! ([`InputError`]): the model responds to that mostly at its resonance, where the parameters are learned. One
//! Gauss-Newton step from the best point, with its derivatives, refits all unknowns: shared ones, clocks,
//! departures, linear nuisances. It is exact for a small change; where a second step moves the first replicates
//! by more than a tenth of the first one, all take it.
//!
//! The interval is the value plus and minus the replicates' standard deviation times Student's t, within the
//! bounds. A standard deviation needs fewer replicates than a quantile does. The variance is increased by the
//! scatter between explanations of other structure that have the same parameter, weighted by their
//! probabilities.
//!
//! Source: Efron and Tibshirani, An Introduction to the Bootstrap (1993), chapters 6 and 12; Bardsley,
//! Solonen, Haario and Laine, SIAM J. Scientific Computing 36 (2014) on beliefs that are drawn, too.

mod output_noise;

use super::evidence::CALIBRATED;
use super::explanation::Explanation;
use super::fit::Linearised;
use super::found::Found;
use super::input_error::drawn;
use super::normal::{covariance, deviations, scales, solve};
use super::outcome::Options;
use super::point::{Global, Point};
use super::problem::Problem;
use super::search::Search;
use super::stop::Stop;
use nalgebra::{DMatrix, DVector};
use output_noise::OutputNoise;
use quell_model::{Experiment, InputError, Value};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;

/// Number of replicates `R`. The relative error of their standard deviation is `1 / sqrt(2 R)`, 7 %.
const REPLICATES: u64 = 100;
/// Two-sided 95 % of Student's distribution with that many degrees of freedom.
const STUDENT_95: f64 = 1.984;
/// Replicates that show whether one step is enough.
const PILOTS: u64 = 8;
/// Share of the first step below which a second step is not worth its simulation: the standard deviation of the
/// replicates is not known better.
const LINEAR: f64 = 0.1;

/// How far the shared unknowns would scatter.
pub struct Scatter {
    globals: Vec<Global>,
    /// Covariance about the fitted values, in the unit of the fit.
    covariance: DMatrix<f64>,
    /// Whether replicates were drawn; otherwise the covariance is that of the linearised fit.
    pub is_drawn: bool,
}

impl Scatter {
    /// 95 % confidence interval of a parameter of an effect or a key of the model, in its own unit, within its bounds. A
    /// parameter that was chosen, not fitted, as a range or a side, has its value at both ends.
    pub fn interval(&self, problem: &Problem, point: &Point, global: Global) -> [f64; 2] {
        let value = problem.get(point, global);
        if let Global::Parameter(term, index) = global
            && !point.terms[term].effect.parameters[index].role.is_fitted()
        {
            return [value; 2];
        }
        let (low, high) = problem.limits(point, global);
        let index = self.globals.iter().position(|g| *g == global);
        let reach = index.map_or(f64::INFINITY, |i| {
            STUDENT_95 * self.covariance[(i, i)].sqrt()
        });
        let own = |value: f64| match problem.logarithmic(global) {
            true => value.exp(),
            false => value,
        };
        [
            own(value - reach).max(low.min(own(value))),
            own(value + reach).min(high.max(own(value))),
        ]
    }

    /// Covariance of some of the unknowns; 0 for those that were not fitted.
    pub fn covariance(&self, unknowns: &[Global]) -> DMatrix<f64> {
        let index = |global: &Global| self.globals.iter().position(|g| g == global);
        let indices: Vec<Option<usize>> = unknowns.iter().map(index).collect();
        DMatrix::from_fn(indices.len(), indices.len(), |i, j| {
            let both = indices[i].zip(indices[j]);
            both.map_or(0.0, |at| self.covariance[at])
        })
    }
}

/// The scatter of the unknowns of an explanation in its final fit; the same for the same seed, on any number of threads.
///
/// Replicates that are not all drawn before the search was to end are not used.
pub fn bootstrap(search: &Search, best: &Explanation, found: &Found, options: &Options) -> Scatter {
    let world = World::new(search, best, &options.enough);
    let shared = world.linear.globals.len();
    let drawn = world.drawn(options.seed);
    let is_drawn = drawn.is_some();
    let mut covariance = drawn.unwrap_or_else(|| world.linearised());
    // The variance is at least that of the linear problem with noise alone, which needs no draw. It is taken
    // about the fitted value, so that a bias counts.
    widen(&mut covariance, &deviations(&world.normal, shared));
    // It is also at least that of the evidence, which allows for laws of uncertain shape and for the size and
    // the correlation of the residual.
    let believed = best.evidence.deviations(found.temperature / CALIBRATED);
    widen(&mut covariance, &believed[..shared]);
    let wider = |(i, global): (usize, &Global)| {
        let between = found.between(*global);
        (covariance[(i, i)] + between).sqrt()
    };
    let wider: Vec<f64> = world.linear.globals.iter().enumerate().map(wider).collect();
    widen(&mut covariance, &wider);
    Scatter {
        covariance,
        globals: world.linear.globals,
        is_drawn,
    }
}

/// Raises standard deviations to at least these; the correlations stay as they are.
fn widen(covariance: &mut DMatrix<f64>, least: &[f64]) {
    for (i, least) in least.iter().enumerate() {
        let own = covariance[(i, i)].sqrt();
        if *least <= own {
            continue;
        }
        if own > 0.0 && least.is_finite() {
            covariance.row_mut(i).scale_mut(least / own);
            covariance.column_mut(i).scale_mut(least / own);
        }
        covariance[(i, i)] = least * least;
    }
}

/// The best explanation, taken for the truth.
struct World<'a> {
    search: &'a Search<'a>,
    point: &'a Point,
    linear: Linearised,
    normal: DMatrix<f64>,
    /// What is predicted, for each experiment and output.
    predicted: Vec<Vec<Vec<f64>>>,
    noise: Vec<Vec<OutputNoise>>,
    input: Vec<InputError>,
    /// Ends the replicates.
    stop: Stop,
}

impl<'a> World<'a> {
    fn new(search: &'a Search<'a>, best: &'a Explanation, enough: &Stop) -> Self {
        let problem = search.problem;
        let point = &best.fitted.point;
        let linear = problem.linearise(point, search.projector);
        let (mut predicted, mut noise) = (Vec::new(), Vec::new());
        for (e, experiment) in problem.experiments.iter().enumerate() {
            let left = problem.explained(point, e);
            let less = |(values, left): (&Vec<f64>, &Vec<f64>)| {
                values.iter().zip(left).map(|(y, r)| y - r).collect()
            };
            let values = experiment.outputs.iter().map(|output| &output.values);
            predicted.push(values.zip(&left).map(less).collect());
            noise.push(output_noise::of(search, best, e, &left));
        }
        // The noise of an input that counts as noise of the outputs is drawn with theirs, if it is as large at any time.
        let error = |e: usize| match InputError::of(&problem.experiments[e]) {
            InputError::White(_) | InputError::Walk(_) | InputError::Smoothed(_)
                if problem.heard_input_noise(e).is_some() =>
            {
                InputError::None
            }
            error => error,
        };
        Self {
            search,
            point,
            normal: problem.normal(point, &linear),
            linear,
            predicted,
            noise,
            input: (0..problem.experiments.len()).map(error).collect(),
            stop: problem.stop.or(enough),
        }
    }

    /// Covariance of the shared unknowns over the replicates; `None` where there was no time for all of them.
    fn drawn(&self, seed: u64) -> Option<DMatrix<f64>> {
        let run = |range: std::ops::Range<u64>, steps: usize| -> Option<Vec<Vec<DVector<f64>>>> {
            let one = |index| {
                let replicate = (!self.stop.now()).then(|| self.replicate(seed, index, steps));
                replicate.filter(|_| !self.stop.was_asked())
            };
            range.into_par_iter().map(one).collect()
        };
        let pilots = run(0..PILOTS, 2)?;
        let steps = if self.linear_enough(&pilots) { 1 } else { 2 };
        let others = run(PILOTS..REPLICATES, steps)?;
        let shared = self.linear.globals.len();
        let mut covariance = DMatrix::zeros(shared, shared);
        for replicate in pilots.iter().chain(&others) {
            let changes = replicate.iter().take(steps);
            let change = changes.fold(DVector::zeros(shared), |sum, step| sum + step);
            covariance.ger(1.0, &change, &change, 1.0);
        }
        Some(covariance / REPLICATES as f64)
    }

    /// Covariance of the shared unknowns from the normal matrix.
    fn linearised(&self) -> DMatrix<f64> {
        let (scale, shared) = (scales(&self.normal), self.linear.globals.len());
        let whole = covariance(&self.normal, &scale);
        DMatrix::from_fn(shared, shared, |i, j| {
            let own = whole.as_ref().map_or(0.0, |whole| whole[(i, j)]);
            own / (scale[i] * scale[j])
        })
    }

    /// Changes of the shared unknowns, a Gauss-Newton step each.
    fn replicate(&self, seed: u64, index: u64, steps: usize) -> Vec<DVector<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(index);
        let count = self.search.problem.experiments.len();
        let experiments: Vec<Experiment> = (0..count)
            .map(|e| self.experiment(e, &mut random))
            .collect();
        let problem = Problem {
            experiments: &experiments,
            beliefs: self.beliefs(&mut random),
            given: self.given(&mut random),
            stop: self.stop.clone(),
            ..self.search.problem.clone()
        };
        let (mut point, mut changes) = (self.point.clone(), Vec::new());
        let shared = self.linear.globals.len();
        for _ in 0..steps {
            let rows = |e| {
                let projector = self.search.projector;
                projector.remove(e, &problem.complete(e, &problem.run(&point, e).residuals))
            };
            let residuals: Vec<DVector<f64>> = (0..count).map(rows).collect();
            let gradient = problem.gradient(&point, &self.linear, &residuals);
            let Some(step) = solve(&self.normal, &gradient, 0.0) else {
                break;
            };
            point = problem.stepped(&point, &self.linear.globals, &step);
            changes.push(-step.rows(0, shared));
        }
        changes
    }

    /// One experiment, recorded once more.
    fn experiment(&self, e: usize, random: &mut ChaCha8Rng) -> Experiment {
        let recorded = &self.search.problem.experiments[e];
        let mut again = match drawn(self.input[e], &recorded.input_values, random) {
            Some(input) => recorded.with_input(input),
            None => recorded.clone(),
        };
        // Residuals at the same time in several outputs belong together: the same blocks are drawn for all
        // outputs.
        let blocks = random.clone();
        for (k, output) in again.outputs.iter_mut().enumerate() {
            output.values = self.noise[e][k].on(&self.predicted[e][k], random, &blocks);
            for (_, value) in &mut output.witness {
                *value = random.sample(StandardNormal);
            }
        }
        again
    }

    /// The beliefs on the keys, drawn again: a belief is a measurement, too, whose true value is the fitted
    /// one.
    fn beliefs(&self, random: &mut ChaCha8Rng) -> Vec<(f64, f64)> {
        let problem = self.search.problem;
        let mut beliefs = problem.beliefs.clone();
        for &key in &problem.free {
            let (value, std) = (self.point.keys[key], beliefs[key].1);
            if std.is_finite() {
                let miss: f64 = std * random.sample::<f64, _>(StandardNormal);
                beliefs[key].0 = match problem.kind.keys[key].range.0 > 0.0 {
                    true => value * miss.exp(),
                    false => value + miss,
                };
            }
        }
        beliefs
    }

    /// The same for the parameters of the given model's effects.
    fn given(&self, random: &mut ChaCha8Rng) -> Vec<Vec<Value>> {
        let mut given = self.search.problem.given.clone();
        for (values, term) in given.iter_mut().zip(&self.point.terms) {
            for (value, fitted) in values.iter_mut().zip(&term.values) {
                if let Some(std) = value.std {
                    value.value = fitted + std * random.sample::<f64, _>(StandardNormal);
                }
            }
        }
        given
    }

    /// Whether second steps are small beside first ones, for all shared unknowns together.
    fn linear_enough(&self, pilots: &[Vec<DVector<f64>>]) -> bool {
        let square = |unknown: usize, step: usize| -> f64 {
            let changes = pilots.iter().filter_map(|changes| changes.get(step));
            changes.map(|change| change[unknown].powi(2)).sum()
        };
        let small = |unknown| square(unknown, 1) <= LINEAR * LINEAR * square(unknown, 0);
        // A second step that does not get closer is not a better answer either.
        let farther = |unknown| square(unknown, 1) >= square(unknown, 0);
        let all = || 0..self.linear.globals.len();
        all().all(small) || all().any(farther)
    }
}

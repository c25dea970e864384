//! Search with long integration steps; its explanations are fitted again with short ones.
//!
//! For a linear chain a one-step method is exact for a chain of slightly other frequency and damping, which a
//! fit of the keys compensates. Only the error of long steps beyond that counts. If no sensor would see it, the
//! search for a structure does not need short steps.
//!
//! Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, chapter IX, for the modified equation.

use super::baseline::first_guess;
use super::candidate::Known;
use super::explanation::Explanation;
use super::fit::Linearised;
use super::judge::Judge;
use super::outcome::Progress;
use super::point::Point;
use super::pool::Pool;
use super::problem::Problem;
use super::projector::{Projector, orthonormal};
use super::settled::{search, settled};
use super::thresholds::LONG;
use nalgebra::DMatrix;
use quell_model::Experiment;

/// Greatest error of long steps that does not matter to a search, in standard deviations of a sensor's noise.
const UNSEEN: f64 = 0.2;

/// The result of a search with long steps, fitted again with the steps of the problem; `None` where sensors
/// would see the error of long steps.
pub fn searched_in_long_steps(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &mut Judge,
    baseline: &Explanation,
    told: (&Known, Progress),
) -> Option<Pool> {
    let point = &baseline.fitted.point;
    let shorter = (0..).map_while(|halved| judge.data.in_long_steps(judge.model, halved));
    let mut shorter = shorter.peekable();
    shorter.peek()?;
    let unseen = Unseen::new(problem, point);
    let long = shorter.find(|long| unseen.is_error_of(&long.experiments))?;
    let mut own = Problem {
        experiments: &long.experiments,
        ..problem.clone()
    };
    let mut other = Judge::new(judge.model, &long, &own, point);
    let fitted = own.fit(point, projector, LONG);
    let first = other.judge(&own, projector, fitted);
    let pool = settled(&mut own, projector, &mut other, Pool::new(first), told);
    problem.sensor_noise = own.sensor_noise;
    (problem.noise, problem.whitening) = (own.noise, own.whitening);
    problem.rounding_at_rest = own.rounding_at_rest;
    judge.rounding_apart = other.rounding_apart;
    Some(match problem.is_cut() {
        // It is fitted again where the search ends.
        true => pool,
        false => search(problem, projector, judge, told).fitted_again(&pool),
    })
}

/// Whether the error of long steps, beyond what the model's keys compensate, is too small for the sensors.
struct Unseen<'a> {
    short: Problem<'a>,
    point: &'a Point,
    projector: Projector,
    /// With the steps of the problem.
    here: Linearised,
    /// Bases of what the keys compensate, for each experiment.
    bases: Vec<DMatrix<f64>>,
}

impl<'a> Unseen<'a> {
    /// At a point, with a first guess of the noise.
    fn new(problem: &Problem<'a>, point: &'a Point) -> Self {
        let short = Problem {
            whitening: problem.experiments.iter().map(first_guess).collect(),
            ..problem.clone()
        };
        let projector = Projector::new(&short);
        let here = short.linearise(point, &projector);
        Self {
            bases: here.jacobians.iter().cloned().map(orthonormal).collect(),
            short,
            point,
            projector,
            here,
        }
    }

    /// Whether no sensor sees the error of the steps of these experiments.
    fn is_error_of(&self, experiments: &[Experiment]) -> bool {
        let long = Problem {
            experiments,
            ..self.short.clone()
        };
        let there = long.evaluate(self.point, &self.projector);
        let (mut square, mut rows) = (0.0, 0);
        for (e, basis) in self.bases.iter().enumerate() {
            let change = &there.residuals[e] - &self.here.residuals[e];
            square += (&change - basis * basis.tr_mul(&change)).norm_squared();
            rows += change.len();
        }
        square <= UNSEEN.powi(2) * rows as f64
    }
}

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
use super::judge::Judge;
use super::outcome::Progress;
use super::point::Point;
use super::pool::Pool;
use super::problem::Problem;
use super::projector::{Projector, orthonormal};
use super::settled::{search, settled};
use super::thresholds::LONG;

/// Greatest error of long steps that does not matter to a search, in standard deviations of a sensor's noise.
const UNSEEN: f64 = 0.2;

/// The result of a search with long steps, fitted again with the steps of the problem; `None` where sensors
/// would see the error of long steps.
pub fn searched_in_long_steps(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &Judge,
    baseline: &Explanation,
    told: (&Known, Progress),
) -> Option<Pool> {
    let long = judge.data.in_long_steps(judge.model)?;
    let point = &baseline.fitted.point;
    let mut own = Problem {
        experiments: &long.experiments,
        ..problem.clone()
    };
    if !is_unseen(problem, &own, point) {
        return None;
    }
    let other = Judge::new(judge.model, &long, &own, point);
    let fitted = own.fit(point, projector, LONG);
    let first = other.judge(&own, projector, fitted);
    let pool = settled(&mut own, projector, &other, Pool::new(first), told);
    (problem.noise, problem.whitening) = (own.noise, own.whitening);
    Some(search(problem, projector, judge, told).fitted_again(&pool))
}

/// Whether the error of long steps, beyond what the model's keys compensate, is too small for the sensors.
fn is_unseen(short: &Problem, long: &Problem, point: &Point) -> bool {
    let noise = short.experiments.iter().map(first_guess).collect();
    let short = Problem {
        whitening: noise,
        ..short.clone()
    };
    let long = Problem {
        whitening: short.whitening.clone(),
        ..long.clone()
    };
    let projector = Projector::new(&short);
    let here = short.linearise(point, &projector);
    let there = long.evaluate(point, &projector);
    let (mut square, mut rows) = (0.0, 0);
    for (e, jacobian) in here.jacobians.iter().enumerate() {
        let change = &there.residuals[e] - &here.residuals[e];
        let basis = orthonormal(jacobian.clone());
        square += (&change - &basis * basis.tr_mul(&change)).norm_squared();
        rows += change.len();
    }
    square <= UNSEEN.powi(2) * rows as f64
}

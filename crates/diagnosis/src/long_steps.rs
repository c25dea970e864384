//! The search in long steps of the integration, its explanations fitted again in short ones.
//!
//! A one-step method makes of a linear chain another one, of slightly other frequency and damping, which a fit of the
//! keys finds: what long steps are wrong by beyond that is what counts. Where no sensor would see it, the search for a
//! structure needs no short steps.
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

/// Error of long steps in standard deviations of a sensor's noise that a search does not see.
const UNSEEN: f64 = 0.2;

/// What a search in long steps finds, fitted again in the steps of the problem; nothing where steps as long show.
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

/// Whether what long steps are wrong by beyond what the keys of the model make is less than the sensors see.
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

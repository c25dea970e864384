//! The search, by the noise that the best explanation leaves: what is not smooth in a mismatch passes for noise
//! until the mismatch is explained.

use super::candidate::Known;
use super::descent::Descent;
use super::explanation::{Explanation, Judge};
use super::fit::Projector;
use super::found::Found;
use super::outcome::Progress;
use super::pool::Pool;
use super::problem::Problem;
use super::search::Search;
use super::thresholds::LONG;
use super::weights::measured_again;
use rayon::prelude::*;

/// Times that the noise is measured again: with one effect in the model, and with all.
const AGAIN: usize = 3;

/// What a refitted model lacks.
pub fn settled(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &Judge,
    baseline: Explanation,
    told: (&Known, Progress),
) -> Found {
    let first = search(problem, projector, judge, told);
    let mut pool = Pool::new(baseline);
    for single in first.extend(pool.baseline(), pool.temperature(judge)) {
        pool.add(single);
    }
    for _ in 0..AGAIN {
        pool = with_noise_of_best(problem, projector, judge, pool, told);
        search(problem, projector, judge, told).run(&mut pool);
        let best = pool.ranked(pool.temperature(judge))[0].0;
        if measured_again(problem, &best.fitted.point).is_none() {
            break;
        }
    }
    search(problem, projector, judge, told).found(pool)
}

/// The explanations, fitted again where the best one tells another noise.
fn with_noise_of_best(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &Judge,
    pool: Pool,
    told: (&Known, Progress),
) -> Pool {
    let best = pool.ranked(pool.temperature(judge))[0].0;
    let Some(again) = measured_again(problem, &best.fitted.point) else {
        return pool;
    };
    (problem.noise, problem.whitening) = again;
    *projector = Projector::new(problem);
    let search = search(problem, projector, judge, told);
    let refit = |own: &Explanation| {
        let mut descent = Descent::new(search.problem, search.projector, &own.fitted.point, None);
        descent.run(LONG);
        if descent.winds() {
            descent.hop();
        }
        judge.judge(search.problem, search.projector, descent.end())
    };
    let mut again = Pool::new(refit(pool.baseline()));
    let others: Vec<&Explanation> = pool.iter().skip(1).collect();
    let others: Vec<Explanation> = others.into_par_iter().map(refit).collect();
    others.into_iter().for_each(|own| again.add(own));
    again
}

/// A search by the noise as it is known.
pub fn search<'a>(
    problem: &'a Problem<'a>,
    projector: &'a Projector,
    judge: &'a Judge<'a>,
    (known, progress): (&'a Known, Progress<'a>),
) -> Search<'a> {
    Search {
        problem,
        projector,
        judge,
        known,
        progress,
    }
}

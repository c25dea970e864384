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
use super::screen::Table;
use super::search::Search;
use super::thresholds::LONG;
use super::weights::measured_again;

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
    let mut pool = Pool::new(baseline);
    // By single laws of the catalogue first: what these leave tells the noise, and whether there is more to look for.
    let baseline = pool.baseline().clone();
    search(problem, projector, judge, told).extend_by(&mut pool, &baseline, Table::Named);
    for _ in 0..AGAIN {
        let measured = with_noise_of_best(problem, projector, judge, &pool, told);
        pool = measured.unwrap_or(pool);
        let before = pool.extended();
        search(problem, projector, judge, told).run(&mut pool);
        if pool.extended() == before {
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
    pool: &Pool,
    told: (&Known, Progress),
) -> Option<Pool> {
    let best = pool.best(judge);
    (problem.noise, problem.whitening) = measured_again(problem, &best.fitted.point)?;
    *projector = Projector::new(problem);
    let search = search(problem, projector, judge, told);
    Some(pool.map(judge, |own| {
        let mut descent = Descent::new(search.problem, search.projector, &own.fitted.point, None);
        descent.run(LONG);
        if descent.winds() {
            descent.hop();
        }
        judge.judge(search.problem, search.projector, descent.end())
    }))
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

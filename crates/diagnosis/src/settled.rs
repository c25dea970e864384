//! The search with the noise that the best explanation leaves: the rough part of a mismatch is taken for noise
//! until the mismatch is explained.

use super::candidate::Known;
use super::descent::Descent;
use super::judge::Judge;
use super::outcome::Progress;
use super::point::Point;
use super::pool::{KEPT, KEPT_AT_A_CUT, Pool};
use super::problem::Problem;
use super::projector::Projector;
use super::screen::Table;
use super::search::Search;
use super::thresholds::LONG;
use super::weights;

/// Most times that the noise is measured again: with one effect in the model, and with all.
const AGAIN: usize = 3;

/// Explanations of the mismatch of a refitted model, beside those that are known.
pub fn settled(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &mut Judge,
    mut pool: Pool,
    told: (&Known, Progress),
) -> Pool {
    search(problem, projector, judge, told).recall(&mut pool);
    // Single laws of the catalogue come first. Their residual shows the noise, and whether there is more to
    // search for.
    let baseline = pool.baseline().clone();
    if !pool.is_extended(&baseline, Table::Named) {
        search(problem, projector, judge, told).extend_by(&mut pool, &baseline, Table::Named);
    }
    for _ in 0..AGAIN {
        if problem.is_cut() {
            break;
        }
        let measured = with_noise_of_best(problem, projector, judge, &pool, told);
        pool = measured.unwrap_or(pool);
        let before = pool.extended();
        search(problem, projector, judge, told).run(&mut pool);
        if pool.extended() == before {
            break;
        }
    }
    pool
}

/// The explanations of a search that was cut, fitted to their end with the noise that the best of them leaves. The
/// problem must not be cut any more.
pub fn finished(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &mut Judge,
    pool: &Pool,
    told: (&Known, Progress),
) -> Pool {
    let best = problem.fit(&pool.best(judge).fitted.point, projector, LONG);
    if measured_again(problem, judge, &best.point) {
        *projector = Projector::new(problem);
    }
    search(problem, projector, judge, told).converged(pool, &best.point)
}

/// The explanations, fitted again if the residual of the best one shows another noise.
fn with_noise_of_best(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &mut Judge,
    pool: &Pool,
    told: (&Known, Progress),
) -> Option<Pool> {
    let best = pool.best(judge).fitted.point.clone();
    if !measured_again(problem, judge, &best) {
        return None;
    }
    *projector = Projector::new(problem);
    Some(search(problem, projector, judge, told).fitted_again(pool))
}

/// Measures the noise and the rounding at rest with a better model. Returns whether either differs from the present one.
fn measured_again(problem: &mut Problem, judge: &mut Judge, point: &Point) -> bool {
    let noise = weights::measured_again(problem, point);
    let rounding = problem.round_again(point);
    if rounding {
        judge.round_again(problem, point);
    }
    noise || rounding
}

impl Search<'_> {
    /// The most probable explanations of a pool, fitted again and thinned out again: parameters may have reached the end of their
    /// range.
    pub fn fitted_again(&self, pool: &Pool) -> Pool {
        let best = &pool.best(self.judge).fitted.point;
        let rival = self.problem.fit(best, self.projector, LONG).cost;
        let mut again = pool.map(self.judge, KEPT, |own| {
            let (problem, projector) = (self.problem, self.projector);
            let mut descent = Descent::new(problem, projector, &own.fitted.point, None);
            descent.run(LONG);
            if descent.winds() {
                descent.hop(rival);
            }
            self.judge.judge(problem, projector, descent.end())
        });
        self.thin_out(&mut again);
        again
    }

    /// The most probable explanations of a pool, each fitted from where its fit was left as long as it may reach the best one,
    /// which was fitted before to a point.
    fn converged(&self, pool: &Pool, best: &Point) -> Pool {
        let best = self.refitted(best);
        pool.map(self.judge, KEPT_AT_A_CUT, |own| {
            if own.is_same(&best) {
                return best.clone();
            }
            let mut descent = Descent::new(self.problem, self.projector, &own.fitted.point, None);
            descent.run_against(LONG, best.fitted.cost);
            self.judge
                .judge(self.problem, self.projector, descent.end())
        })
    }
}

/// A search with the present noise.
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

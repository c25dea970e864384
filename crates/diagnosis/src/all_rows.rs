//! The search in all rows of the recordings; held-out stretches judge what it finds.
//!
//! What happens between two fitted stretches, as a stop that is touched once, shows in the held-out ones only: a fit of the rest
//! may put it anywhere. So structures are searched and fitted in all rows. What was found is then fitted to the fitted rows, and
//! the predictive density of the held-out ones says what of it holds. Windows and recordings that are held out have a start of
//! their own; the search does not see them.

use super::candidate::Known;
use super::explanation::Explanation;
use super::judge::Judge;
use super::long_steps::searched_in_long_steps;
use super::outcome::Progress;
use super::pool::Pool;
use super::problem::Problem;
use super::projector::Projector;
use super::search::Search;
use super::settled::{fitted_to, settled};
use super::split::{self, HeldOut};
use super::thresholds::LONG;

/// A problem over all rows of its recordings.
pub struct AllRows<'a> {
    /// The problem.
    pub problem: Problem<'a>,
    /// Projects its linear nuisances out.
    pub projector: Projector,
}

impl<'a> AllRows<'a> {
    /// The problem of which some rows are fitted, over all of them; `None` where what is held out has a start of its own.
    pub fn of(problem: &Problem<'a>, judge: &Judge) -> Option<Self> {
        let are_stretches = judge.data.judged_by == HeldOut::Stretches;
        are_stretches.then(|| {
            let mut problem = problem.clone();
            problem.rows = problem.experiments.iter().map(split::whole).collect();
            let projector = Projector::new(&problem);
            Self { problem, projector }
        })
    }

    /// A search over all rows.
    pub fn search<'s>(&'s self, own: &Search<'s>, judge: &'s Judge<'s>) -> Search<'s>
    where
        'a: 's,
    {
        Search {
            problem: &self.problem,
            projector: &self.projector,
            judge,
            ..*own
        }
    }
}

/// Explanations of what a refitted model leaves: from a search in all rows, where stretches are held out, fitted to the fitted
/// rows.
pub fn searched(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &mut Judge,
    baseline: Explanation,
    told: (&Known, Progress),
) -> Pool {
    let Some(AllRows {
        problem: mut own,
        projector: mut whole,
    }) = AllRows::of(problem, judge)
    else {
        return searched_here(problem, projector, judge, baseline, told);
    };
    let data = judge.data.with_all_rows();
    let point = &baseline.fitted.point;
    let mut other = Judge::new(judge.model, &data, &own, point);
    let first = other.judge(&own, &whole, own.fit(point, &whole, LONG));
    let pool = searched_here(&mut own, &mut whole, &mut other, first, told);
    fitted_to((problem, projector), judge, (&own, pool), told)
}

/// Explanations from a search in the rows of a problem: with long steps where these do no harm, then with its own.
fn searched_here(
    problem: &mut Problem,
    projector: &mut Projector,
    judge: &mut Judge,
    baseline: Explanation,
    told: (&Known, Progress),
) -> Pool {
    let pool = searched_in_long_steps(problem, projector, judge, &baseline, told);
    let pool = pool.unwrap_or_else(|| Pool::new(baseline));
    settled(problem, projector, judge, pool, told)
}

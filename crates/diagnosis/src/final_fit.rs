//! The final fit: what is told is fitted to all rows once it is chosen.
//!
//! Held-out stretches judge which explanation is told. After that nothing is judged by them any more, and its parameters are
//! those of the whole recording, with the intervals of a fit to all rows: an effect that acted mostly in what was held out is
//! known from there. Windows and recordings that were held out are not fitted: they keep judging the model that is written.
//!
//! Source: Hastie, Tibshirani and Friedman, The Elements of Statistical Learning (2009), section 7.2, on selection by held-out
//! data before a fit to all of them.

use super::data::Data;
use super::explanation::Explanation;
use super::found::Found;
use super::judge::Judge;
use super::problem::Problem;
use super::projector::Projector;
use super::search::Search;
use super::split::{self, HeldOut};
use super::stop::Stop;

/// A problem over all rows of the fitted recordings.
pub struct AllRows<'a> {
    /// The problem.
    pub problem: Problem<'a>,
    /// Projects its linear nuisances out.
    pub projector: Projector,
}

impl<'a> AllRows<'a> {
    /// All rows where stretches are held out.
    pub fn of(problem: &Problem<'a>) -> Self {
        let mut problem = problem.clone();
        problem.rows = problem.experiments.iter().map(split::whole).collect();
        let projector = Projector::new(&problem);
        Self { problem, projector }
    }
}

/// What is told, fitted for the last time.
pub struct Final {
    /// The refitted model.
    pub baseline: Explanation,
    /// The reported explanation.
    pub best: Explanation,
}

/// Calls a function with the search over the rows of the final fit, and with what is fitted to them. Where the time is over,
/// what is told stays as it was fitted.
pub fn with_final_fit<T>(
    search: &Search,
    found: &Found,
    enough: &Stop,
    then: impl FnOnce(&Search, &Final) -> T,
) -> T {
    let data = search.judge.data;
    if data.judged_by != HeldOut::Stretches || enough.now() {
        let last = Final {
            baseline: found.baseline.clone(),
            best: found.best.clone(),
        };
        return then(search, &last);
    }
    let AllRows { problem, projector } = AllRows::of(search.problem);
    let data = Data {
        train: problem.rows.clone(),
        held_out: data
            .held_out
            .iter()
            .map(|own| vec![Vec::new(); own.len()])
            .collect(),
        experiments: data.experiments.clone(),
        apart: Vec::new(),
        judged_by: data.judged_by,
    };
    let start = &found.baseline.fitted.point;
    let judge = Judge::new(search.judge.model, &data, &problem, start);
    let whole = Search {
        problem: &problem,
        projector: &projector,
        judge: &judge,
        ..*search
    };
    let [baseline, best] =
        [&found.baseline, &found.best].map(|own| whole.refitted(&own.fitted.point));
    then(&whole, &Final { baseline, best })
}

//! The final fit: what is told is fitted to all rows once it is chosen.
//!
//! Held-out stretches judge which explanation is told. After that nothing is judged by them any more, and its parameters are
//! those of the whole recording, with the intervals of a fit to all rows: an effect that acted mostly in what was held out is
//! known from there. Windows and recordings that were held out are not fitted: they keep judging the model that is written.
//!
//! Source: Hastie, Tibshirani and Friedman, The Elements of Statistical Learning (2009), section 7.10.1: the model that
//! held-out data chose is fitted to all data.

use super::explanation::Explanation;
use super::found::Found;
use super::judge::Judge;
use super::search::Search;
use super::stop::Stop;

/// Calls a function with the search over the rows of the final fit, and with the refitted model and the best explanation as
/// they are fitted to them. Where the time is over, both stay as they were fitted.
pub fn with_final_fit<T>(
    search: &Search,
    found: &Found,
    enough: &Stop,
    then: impl FnOnce(&Search, [&Explanation; 2]) -> T,
) -> T {
    let Some(all) = search.all_rows().filter(|_| !enough.now()) else {
        return then(search, [&found.baseline, &found.best]);
    };
    let data = search.judge.data.with_all_rows();
    let start = &found.baseline.fitted.point;
    let judge = Judge::new(search.judge.model, &data, &all.problem, start);
    let whole = Search {
        judge: &judge,
        ..all.search(search)
    };
    let baseline = whole.refitted(start);
    let best = (found.best.terms() > 0).then(|| whole.refitted(&found.best.fitted.point));
    then(&whole, [&baseline, best.as_ref().unwrap_or(&baseline)])
}

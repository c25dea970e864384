//! What is reported has parameters that a bootstrap determines, too: the noise may scatter the parameters of a law more than
//! the curvature of the fit says.

use super::bootstrap::{Scatter, bootstrap};
use super::explanation::Explanation;
use super::found::Found;
use super::meaning::{added, is_one_value, spans};
use super::outcome::Options;
use super::point::Global;
use super::pool::Pool;
use super::search::Search;

impl Search<'_> {
    /// The conclusions from a pool, with the scatter of what is reported. An explanation is not reported if the 95 % interval
    /// of a position, an instant, a period or a frequency is as wide as its range.
    pub fn determined(&self, mut pool: Pool, options: &Options) -> (Found, Scatter) {
        loop {
            let found = self.found(pool.clone());
            let scatter = bootstrap(self, &found, options);
            if self.determine(&found.best, &scatter) {
                return (found, scatter);
            }
            pool.refuse(&found.best);
        }
    }

    fn determine(&self, own: &Explanation, scatter: &Scatter) -> bool {
        let point = &own.fitted.point;
        added(point, &own.fitted.globals).all(|(_, term, index)| {
            let global = Global::Parameter(term, index);
            let term = &point.terms[term];
            let role = term.effect.parameters[index].role;
            let known = (term.values[index], scatter.deviation(global).unwrap_or(0.0));
            !is_one_value(role) || !spans(role, known, self.problem.limits(point, global))
        })
    }
}

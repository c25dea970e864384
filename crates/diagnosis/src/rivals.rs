//! Rivals of an explanation that leaves only noise: structures that leave a mismatch, and that one more effect could bring
//! into its credible set. A complicated law may be two simple ones.

use super::explanation::Explanation;
use super::found::{contains, least_credible};
use super::pool::Pool;
use super::screen::Table;
use super::search::Search;
use super::thresholds::BEAM;

impl Search<'_> {
    /// If only noise is left, extends the other structures that could become credible. What holds the best explanation is left
    /// out: it was looked for before. Returns whether there is a better explanation.
    pub fn extend_rivals(&self, pool: &mut Pool) -> bool {
        let before = pool.best(self.judge).clone();
        while !self.is_over()
            && pool.best(self.judge).is_like(&before)
            && let Some(rival) = self.rival(pool)
        {
            let children = self.extend(&rival, Table::Named, pool).into_iter();
            let others = children.filter(|child| !contains(child, &before));
            others.for_each(|child| pool.add(child));
            pool.mark(&rival, Table::Named);
            self.thin_out(pool);
        }
        !pool.best(self.judge).is_like(&before)
    }

    /// A structure that is not extended yet, and that one more effect could bring into the credible set of an explanation
    /// that leaves only noise, the simplest one first.
    fn rival(&self, pool: &Pool) -> Option<Explanation> {
        let temperature = pool.temperature(self.judge);
        let ranked = pool.ranked(temperature);
        let (best, highest) = ranked[0];
        if best.is_learned() || !self.leaves_noise(best) {
            return None;
        }
        let one = self.problem.log_prior_of_one();
        let least = least_credible(highest);
        let is_rival = |own: &&(&Explanation, f64)| {
            !pool.is_extended(own.0, Table::Named) && pool.hope(**own, one, temperature) > least
        };
        (0..=best.terms()).find_map(|count| {
            let named = ranked
                .iter()
                .filter(|own| own.0.terms() == count && !own.0.is_learned());
            named.take(BEAM).find(is_rival).map(|own| own.0.clone())
        })
    }
}

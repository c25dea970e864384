//! Fits to fitted and held-out rows together, as starts of a fit.
//!
//! The predictive density of held-out rows takes the unknowns for Gaussian about the fit. A law that hardly acted in the
//! fitted rows, as a stop that was touched once, has a posterior that is curved and long: the fit may be anywhere in it, and
//! the held-out rows alone contradict where it is. Somewhere else they may not. The marginal likelihood of the whole recording
//! is that of the best of these places.

use super::explanation::Explanation;
use super::pool::Pool;
use super::problem::Rows;
use super::projector::Projector;
use super::search::Search;
use super::split::HeldOut;
use super::thresholds::{BEAM, LONG, least_credible};
use rayon::prelude::*;

impl Search<'_> {
    /// If the best explanation fits down to the noise, fits structures again from the optimum of all rows. Returns
    /// whether there is a better explanation.
    pub fn fit_to_all_rows(&self, pool: &mut Pool) -> bool {
        let before = pool.best(self.judge).clone();
        if self.judge.fits_to_noise(&before) {
            self.refit_doubtful(pool, |pool| pool.temperature(self.judge));
        }
        !pool.best(self.judge).is_like(&before)
    }

    /// Fits the structures of a pool again from the optimum of all rows that would be credible at a temperature if their held-out
    /// rows left only noise, and do not.
    pub fn refit_doubtful(&self, pool: &mut Pool, temperature: impl Fn(&Pool) -> f64) {
        while self.judge.data.judged_by == HeldOut::Stretches && !self.is_over() {
            let temperature = temperature(pool);
            let doubtful = self.doubtful(pool, temperature);
            if doubtful.is_empty() {
                break;
            }
            pool.mark_fitted_to_all(&doubtful);
            let again = doubtful.par_iter().map(|own| self.fitted_to_all_rows(own));
            let again: Vec<Explanation> = again.collect();
            for (own, from) in again.into_iter().zip(&doubtful) {
                self.log(&own, from, temperature);
                pool.add(own);
            }
        }
    }

    fn doubtful(&self, pool: &Pool, temperature: f64) -> Vec<Explanation> {
        let ranked = pool.ranked(temperature);
        let least = least_credible(ranked[0].1);
        let rows = self.judge.held_out_rows as f64;
        let hope = |own: &(&Explanation, f64)| {
            let beyond = own.0.evidence.held_out_beyond_fit() - rows;
            own.1 + beyond.max(0.0) / (2.0 * temperature)
        };
        let is_doubtful = |own: &&(&Explanation, f64)| {
            own.0.terms() > 0
                && !self.leaves_noise(own.0)
                && hope(own) > least
                && !pool.is_fitted_to_all(own.0)
        };
        let all = ranked.iter().filter(is_doubtful);
        all.take(BEAM).map(|own| own.0.clone()).collect()
    }

    fn fitted_to_all_rows(&self, own: &Explanation) -> Explanation {
        let mut whole = self.problem.clone();
        for (rows, held_out) in whole.rows.iter_mut().zip(&self.judge.data.held_out) {
            let outputs = rows.iter_mut().zip(held_out);
            outputs.for_each(|(rows, held_out)| *rows = joined(rows, held_out));
        }
        let projector = Projector::new(&whole);
        let all = whole.fit(&own.fitted.point, &projector, LONG);
        self.refitted(&all.point)
    }
}

/// Ranges of both, in order, adjacent ones as one.
fn joined(fitted: &Rows, held_out: &Rows) -> Rows {
    let mut all: Rows = fitted.iter().chain(held_out).cloned().collect();
    all.sort_by_key(|range| range.start);
    let mut joined = Rows::new();
    for range in all {
        match joined.last_mut().filter(|last| last.end == range.start) {
            Some(last) => last.end = range.end,
            None => joined.push(range),
        }
    }
    joined
}

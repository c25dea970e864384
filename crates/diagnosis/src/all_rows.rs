//! Fits to fitted and held-out rows together, as starts of a fit.
//!
//! The predictive density of held-out rows takes the unknowns for Gaussian about the fit. A law that hardly acted in the
//! fitted rows, as a stop that was touched once, has a posterior that is curved and long: the fit may be anywhere in it, and
//! the held-out rows alone contradict where it is. Somewhere else they may not. The marginal likelihood of the whole recording
//! is that of the best of these places.

use super::explanation::Explanation;
use super::pool::Pool;
use super::problem::Problem;
use super::projector::Projector;
use super::search::Search;
use super::split::{self, HeldOut};
use super::thresholds::{BEAM, LONG, least_credible};
use rayon::prelude::*;

/// A problem over all rows of its recordings.
pub struct AllRows<'a> {
    /// The problem.
    pub problem: Problem<'a>,
    /// Projects its linear nuisances out.
    pub projector: Projector,
}

impl<'a> AllRows<'a> {
    /// The problem of which some rows are fitted, over all of them.
    pub fn of(problem: &Problem<'a>) -> Self {
        let mut problem = problem.clone();
        problem.rows = problem.experiments.iter().map(split::whole).collect();
        let projector = Projector::new(&problem);
        Self { problem, projector }
    }
}

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
        let whole = AllRows::of(self.problem);
        let all = whole.problem.fit(&own.fitted.point, &whole.projector, LONG);
        self.refitted(&all.point)
    }
}

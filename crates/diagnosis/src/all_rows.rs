//! Fits to fitted and held-out rows together, as starts of a fit.
//!
//! The predictive density of held-out rows takes the unknowns for Gaussian about the fit. A law that hardly acted in the
//! fitted rows, as a stop that was touched once, has a posterior that is curved and long: the fit may be anywhere in it, and
//! the held-out rows alone contradict where it is. Somewhere else they may not. The marginal likelihood of the whole recording
//! is that of the best of these places.

use super::explanation::Explanation;
use super::point::Point;
use super::pool::Pool;
use super::problem::Problem;
use super::projector::Projector;
use super::screen::Screen;
use super::search::Search;
use super::split::{self, HeldOut};
use super::thresholds::{BEAM, LONG, SECOND, least_credible};
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

    /// A search over all rows.
    pub fn search<'s>(&'s self, own: &Search<'s>) -> Search<'s>
    where
        'a: 's,
    {
        Search {
            problem: &self.problem,
            projector: &self.projector,
            ..*own
        }
    }

    /// Points with other values of one law, beside the others that are fitted without it.
    fn starts_anew(&self, point: &Point, law: usize) -> Vec<Point> {
        let (effect, place) = point.terms[law].identity();
        let (problem, projector) = (&self.problem, &self.projector);
        let part = problem.fit(&point.without(law), projector, LONG).point;
        let linear = problem.linearise(&part, projector);
        let screen = Screen::new(problem, &part, &linear, projector);
        let starts = match effect.is_learned() {
            true => screen.learned(effect, place),
            false => screen.sizes(effect, place, SECOND),
        };
        let starts = starts.into_iter();
        starts.map(|start| part.with(start.term)).collect()
    }
}

impl<'a> Search<'a> {
    /// The problem over all rows where stretches are held out. What is held out elsewhere has a start of its own.
    pub fn all_rows(&self) -> Option<AllRows<'a>> {
        let are_stretches = self.judge.data.judged_by == HeldOut::Stretches;
        are_stretches.then(|| AllRows::of(self.problem))
    }

    /// Fits structures again from the optimum of all rows, before further effects are searched in what they leave. Returns
    /// whether there is a better explanation.
    pub fn fit_to_all_rows(&self, pool: &mut Pool) -> bool {
        let before = pool.best(self.judge).clone();
        self.refit_contradicted(pool, |pool| pool.temperature(self.judge));
        !pool.best(self.judge).is_like(&before)
    }

    /// Fits the structures of a pool again from the optimum of all rows that are contradicted by the held-out ones, and would be
    /// credible at a temperature if these left no more than the fitted rows do.
    pub fn refit_contradicted(&self, pool: &mut Pool, temperature: impl Fn(&Pool) -> f64) {
        while self.judge.data.judged_by == HeldOut::Stretches && !self.is_over() {
            let temperature = temperature(pool);
            let contradicted = self.contradicted(pool, temperature);
            if contradicted.is_empty() {
                break;
            }
            pool.mark_fitted_to_all(&contradicted);
            let again = contradicted
                .par_iter()
                .map(|own| self.fitted_anew_to_all_rows(own, temperature));
            let again: Vec<Explanation> = again.collect();
            for (own, from) in again.into_iter().zip(&contradicted) {
                self.log(&own, from, temperature);
                pool.add(own);
            }
        }
    }

    /// The most hopeful of them. A contradiction that is worth less than an effect is none.
    fn contradicted<'p>(&self, pool: &'p Pool, temperature: f64) -> Vec<Explanation> {
        let ranked = pool.ranked(temperature);
        let least = least_credible(ranked[0].1);
        let hope = |(own, log): (&'p Explanation, f64)| {
            let is_fitted = own.terms() == 0 || pool.is_fitted_to_all(own);
            let contradiction = self
                .contradiction(own, temperature)
                .filter(|_| !is_fitted)?;
            let hope = log + contradiction;
            (hope > least).then_some((own, hope))
        };
        let mut all: Vec<_> = ranked.into_iter().filter_map(hope).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all.into_iter()
            .take(BEAM)
            .map(|own| own.0.clone())
            .collect()
    }

    /// Log of the odds that held-out rows have against an explanation at a temperature, where it is worth an effect.
    fn contradiction(&self, own: &Explanation, temperature: f64) -> Option<f64> {
        let contradiction = self.judge.contradiction(own) / (2.0 * temperature);
        (contradiction > -self.problem.log_prior_of_one()).then_some(contradiction)
    }

    /// A structure, fitted from the optimum of all rows, and judged: what is short may be in held-out rows only.
    pub fn fitted_to_all_rows(&self, start: &Point) -> Explanation {
        match self.all_rows() {
            Some(whole) => {
                let all = whole.problem.fit(start, &whole.projector, LONG);
                self.refitted(&all.point)
            }
            None => self.refitted(start),
        }
    }

    /// The same, and where held-out rows contradict it still, from the best of further starts: for each of its laws the sizes
    /// that are screened best in all rows. What hardly acts in the fitted rows leads their fit to any of its minima.
    fn fitted_anew_to_all_rows(&self, own: &Explanation, temperature: f64) -> Explanation {
        let point = &own.fitted.point;
        let again = self.fitted_to_all_rows(point);
        if self.contradiction(&again, temperature).is_none() {
            return again;
        }
        let Some(whole) = self.all_rows() else {
            return again;
        };
        let laws = point.given_terms..point.terms.len();
        let starts: Vec<Point> = laws.flat_map(|law| whole.starts_anew(point, law)).collect();
        let fits = starts
            .par_iter()
            .map(|start| whole.problem.fit(start, &whole.projector, LONG));
        let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost));
        let anew = best.map(|own| self.refitted(&own.point));
        let log = |own: &Explanation| own.log_evidence(temperature);
        anew.filter(|anew| log(anew) > log(&again)).unwrap_or(again)
    }
}

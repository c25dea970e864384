//! Candidates on top of an explanation: located in its residual, screened, and fitted by successive halving.

use super::candidate::Candidate;
use super::evidence::CALIBRATED;
use super::explanation::Explanation;
use super::fit::Linearised;
use super::point::Point;
use super::pool::Pool;
use super::screen::{Start, Table, screen};
use super::search::Search;
use super::successive_halving::Halving;
use rayon::prelude::*;

/// Candidates that are fitted after the screen.
const FITTED: usize = 10;
/// Learned laws that are fitted after the screen, each from its likeliest curve.
const LEARNED: usize = 3;
/// Sizes of each candidate from which a fit starts: a law with a time or a length has a basin for every few of
/// them.
const SIZES: usize = 8;

impl Search<'_> {
    /// Candidates on top of an explanation, fitted and judged.
    pub fn extend(&self, from: &Explanation, table: Table, pool: &Pool) -> Vec<Explanation> {
        let temperature = pool.temperature(self.judge);
        let before = quell_model::simulations();
        let mut located = self.problem.clone();
        located.locate_again(from);
        let search = Search {
            problem: &located,
            ..*self
        };
        let (problem, point) = (search.problem, &from.fitted.point);
        let linear = (!self.known.alone).then(|| problem.linearise(point, self.projector));
        let mut found = Vec::new();
        if let Some(linear) = &linear {
            // The gain that a further effect needs to outweigh its prior odds, for an uncorrelated residual. In
            // a correlated one an effect may explain everything.
            let fall = -2.0 * CALIBRATED * pool.unit(self.judge) * problem.log_prior_of_one();
            found = search.screened(from, linear, table, fall);
        }
        let mut halving = Halving::new(&search, from, linear.as_ref(), pool);
        halving.enter(found);
        // Learned laws compete with the best explanation that is known.
        let rival = match table {
            Table::Named => f64::INFINITY,
            Table::Learned => pool.best(self.judge).fitted.cost,
        };
        halving.lead(rival);
        if table == Table::Named {
            let continued = search.continued(from, &halving);
            halving.enter(continued);
        }
        let found = halving.finish();
        found
            .iter()
            .for_each(|own| self.log(own, from, temperature));
        tracing::debug!(
            from = ?point.structure(),
            ?table,
            temperature,
            simulations = quell_model::simulations() - before,
            fitted = found.len(),
            "extended"
        );
        found
    }

    /// The best candidates of a screen.
    fn screened(
        &self,
        from: &Explanation,
        linear: &Linearised,
        table: Table,
        fall: f64,
    ) -> Vec<Candidate> {
        let (problem, point) = (self.problem, &from.fitted.point);
        // A mismatch that the refitted keys have absorbed is found from the believed values.
        let mut believed = point.clone();
        for &key in &problem.free {
            believed.keys[key] = problem.beliefs[key].0;
        }
        let starts = screen(problem, point, linear, self.projector, (table, SIZES));
        let candidate = |starts: Vec<Start>| {
            let with = |from: &Point, s: &Start| from.with(s.term.clone());
            let near = starts.iter().map(|start| with(point, start));
            let near = near.chain([with(&believed, &starts[0])]);
            Candidate {
                effect: starts[0].term.identity(),
                near: near.collect(),
                far: Vec::new(),
            }
        };
        let most = match table {
            Table::Named => FITTED,
            Table::Learned => LEARNED,
        };
        chosen(starts, fall, most)
            .into_iter()
            .map(candidate)
            .collect()
    }

    /// Adds the explanations from another look, fitted to this one.
    pub fn recall(&self, pool: &mut Pool) {
        let start = pool.baseline().fitted.point.clone();
        let again = |known: &Point| {
            let mut point = known.clone();
            point.start_as(&start);
            self.refitted(&point)
        };
        let known = self.known.points.par_iter();
        let known = known.filter(|_| !self.problem.is_cut());
        let recalled: Vec<Explanation> = known.map(again).collect();
        recalled.into_iter().for_each(|own| pool.add(own));
    }

    /// Logs a candidate of the search, for debugging.
    pub(super) fn log(&self, own: &Explanation, from: &Explanation, temperature: f64) {
        let over_noise = |chi: f64, rows: usize| (chi / rows.max(1) as f64).sqrt();
        let terms = own.fitted.point.terms.iter();
        let values: Vec<&[f64]> = terms.map(|term| &term.values[..]).collect();
        let rise = |of: fn(&super::evidence::Evidence, f64) -> f64| {
            of(&own.evidence, temperature) - of(&from.evidence, temperature)
        };
        tracing::debug!(
            effects = ?own.fitted.point.structure(),
            ?values,
            keys = ?own.fitted.point.keys,
            fitted = rise(super::evidence::Evidence::of_fitted),
            held_out = rise(super::evidence::Evidence::of_held_out),
            temperature,
            fitted_over_noise = over_noise(own.train, self.judge.train_rows),
            held_out_over_noise = over_noise(own.held_out, self.judge.held_out_rows),
            "candidate"
        );
    }
}

/// Starts of the best candidates, grouped by effect and place; each promises a fall of the cost of at least
/// `fall`.
fn chosen(starts: Vec<Start>, fall: f64, most: usize) -> Vec<Vec<Start>> {
    let mut groups: Vec<Vec<Start>> = Vec::new();
    for start in starts {
        if start.score < fall {
            break;
        }
        let same = |group: &&mut Vec<Start>| group[0].term.identity() == start.term.identity();
        let room = groups.len() < most;
        match groups.iter_mut().find(same) {
            Some(group) => group.push(start),
            None if room => groups.push(vec![start]),
            None => {}
        }
    }
    groups
}

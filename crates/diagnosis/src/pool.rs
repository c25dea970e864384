//! The explanations of a search, one for each structure and resolution of its curves, with their evidence.

use super::evidence::CALIBRATED;
use super::explanation::Explanation;
use super::judge::Judge;
use super::point::Point;
use super::screen::Table;
use super::thresholds::{BEAM, least_credible};
use quell_model::effects::Place;
use rayon::prelude::*;
use std::cmp::Ordering;

/// Explanations that are fitted again after the noise has changed: more than a credible set has. Those that are far less
/// probable than the best one are among them, since a parameter of that may then be at the end of its range.
pub const KEPT: usize = 12;
/// Explanations that are fitted to their ends where the search was cut: there is no time for more.
pub const KEPT_AT_A_CUT: usize = 6;

/// Assumed relative error of the catalogue's laws, which are idealised; its shape is unknown.
///
/// Source: Kennedy and O'Hagan, J. Royal Statistical Society B 63 (2001).
const DISCREPANCY: f64 = 0.1;

/// An explanation, and what was done with it.
#[derive(Clone)]
struct Entry {
    own: Explanation,
    /// Whether it was fitted again without each of its effects.
    thinned: bool,
    /// Whether it was fitted again from the optimum of all rows.
    from_all: bool,
    /// Fewest named laws of a slot at whose curves learned ones were begun.
    learned_from: usize,
}

impl Entry {
    fn new(own: Explanation) -> Self {
        Self {
            own,
            thinned: false,
            from_all: false,
            learned_from: usize::MAX,
        }
    }
}

/// Explanations, each with a structure of its own.
#[derive(Clone)]
pub struct Pool {
    /// In the order in which they were found; the first is the model as it was given, refitted.
    all: Vec<Entry>,
    /// The structures that were extended, each by the effects of a table. A structure that is not kept when the noise is
    /// measured again stays among them.
    extended: Vec<(Vec<(&'static str, Place)>, Table)>,
    /// Whether structures of more effects than the best one's were searched ahead.
    pub looked_ahead: bool,
    /// Whether the search was ended while there were structures left that it would have fitted.
    pub is_unfinished: bool,
}

impl Pool {
    /// A pool of the refitted model alone.
    pub fn new(baseline: Explanation) -> Self {
        Self {
            all: vec![Entry::new(baseline)],
            extended: Vec::new(),
            looked_ahead: false,
            is_unfinished: false,
        }
    }

    /// Adds an explanation, unless the pool has the same structure, as fine, with a fit that is as likely, were only noise left.
    /// The fitted rows alone do not say which of two fits is better: a law that hardly acts in them is told by the held-out rows.
    pub fn add(&mut self, next: Explanation) {
        let odds = |own: &Explanation| own.log_evidence(CALIBRATED);
        match self.all.iter_mut().find(|entry| entry.own.is_same(&next)) {
            Some(entry) if odds(&next) > odds(&entry.own) => {
                entry.own = next;
                entry.thinned = false;
            }
            Some(_) => {}
            None => self.all.push(Entry::new(next)),
        }
    }

    /// Marks structures as fitted again from the optimum of all rows.
    pub fn mark_fitted_to_all(&mut self, each: &[Explanation]) {
        for entry in &mut self.all {
            entry.from_all |= each.iter().any(|own| entry.own.is_like(own));
        }
    }

    /// Whether a structure was fitted again from the optimum of all rows.
    pub fn is_fitted_to_all(&self, own: &Explanation) -> bool {
        let mut all = self.all.iter().filter(|entry| entry.from_all);
        all.any(|entry| entry.own.is_like(own))
    }

    /// Marks a structure as one in which learned laws were begun at the curves of at least so many named ones of a slot; returns
    /// whether it was not marked before.
    pub fn mark_learned_from(&mut self, own: &Explanation, least: usize) -> bool {
        let mut entries = self.all.iter_mut();
        let entry = entries.find(|entry| entry.own.is_like(own) && entry.learned_from > least);
        entry.map(|entry| entry.learned_from = least).is_some()
    }

    /// The explanation of the highest evidence, even with a parameter at the end of its range.
    pub fn of_highest_evidence(&self, judge: &Judge) -> &Explanation {
        let temperature = self.temperature(judge);
        let log = |own: &Explanation| own.log_evidence(temperature);
        let all = self.all.iter().map(|entry| &entry.own);
        let best = all.max_by(|a, b| log(a).total_cmp(&log(b)));
        best.unwrap_or(self.baseline())
    }

    /// Number of structures.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// The refitted model and so many most probable structures, each fitted anew.
    pub fn map(
        &self,
        judge: &Judge,
        kept: usize,
        refit: impl Fn(&Explanation) -> Explanation + Sync,
    ) -> Self {
        let ranked = self.ranked(self.temperature(judge));
        let first = ranked.iter().take(kept);
        let first: Vec<&Explanation> = first.map(|own| own.0).collect();
        let is_kept =
            |own: &Explanation| own.terms() == 0 || first.iter().any(|other| other.is_like(own));
        let entry = |entry: &Entry| {
            let own = refit(&entry.own);
            Entry {
                // A parameter may have reached the end of its range, and the structures without its effect may not be kept.
                thinned: entry.thinned && !own.is_meaningless,
                from_all: entry.from_all,
                learned_from: entry.learned_from,
                own,
            }
        };
        let kept = self.all.par_iter().filter(|entry| is_kept(&entry.own));
        Self {
            all: kept.map(entry).collect(),
            extended: self.extended.clone(),
            looked_ahead: self.looked_ahead,
            is_unfinished: self.is_unfinished,
        }
    }

    /// The explanation that has the structure of a point, at the likeliest resolution were only noise left.
    pub fn like(&self, point: &Point) -> Option<&Explanation> {
        let all = self.all.iter().map(|entry| &entry.own);
        let odds = |own: &Explanation| own.log_evidence(CALIBRATED);
        all.filter(|own| own.has_structure_of(point))
            .max_by(|a, b| odds(a).total_cmp(&odds(b)))
    }

    /// The model as it was given, refitted.
    pub fn baseline(&self) -> &Explanation {
        &self.all[0].own
    }

    /// The most probable explanation.
    pub fn best(&self, judge: &Judge) -> &Explanation {
        self.ranked(self.temperature(judge))[0].0
    }

    /// The explanations of the credible set, the most probable first.
    pub fn credible(&self, judge: &Judge) -> Vec<Explanation> {
        let ranked = self.ranked(self.temperature(judge));
        let least = least_credible(ranked[0].1);
        let credible = ranked.into_iter().filter(|own| own.1 > least);
        credible.map(|own| own.0.clone()).collect()
    }

    /// The most likely structures of a number of named effects, were only noise left in the end.
    pub fn most_likely(&self, count: usize) -> Vec<Explanation> {
        let ranked = self.ranked(CALIBRATED).into_iter().map(|own| own.0);
        let named = ranked.filter(|own| own.terms() == count && !own.is_learned());
        named.take(BEAM).cloned().collect()
    }

    /// The most likely structure with a learned law, were only noise left in the end.
    pub fn most_likely_learned(&self) -> Option<Explanation> {
        let mut ranked = self.ranked(CALIBRATED).into_iter().map(|own| own.0);
        ranked.find(|own| own.is_learned()).cloned()
    }

    /// Marks a structure as extended by the effects of a table.
    pub fn mark(&mut self, own: &Explanation, table: Table) {
        self.extended.push((own.fitted.point.structure(), table));
    }

    /// The next explanation of several effects to fit again without each of them: the one of the highest evidence, even with a
    /// parameter at the end of its range, then the best. It is marked, so that each is answered once.
    pub fn next_to_thin_out(&mut self, judge: &Judge) -> Option<Explanation> {
        let both = [self.of_highest_evidence(judge), self.best(judge)].map(Clone::clone);
        let is_next = |entry: &Entry, own: &Explanation| !entry.thinned && entry.own.is_like(own);
        let mut several = both.into_iter().filter(|own| own.terms() > 1);
        let entries = &mut self.all;
        several.find(|own| {
            let entry = entries.iter_mut().find(|entry| is_next(entry, own));
            entry.map(|entry| entry.thinned = true).is_some()
        })
    }

    /// Whether a structure was extended by the effects of a table.
    pub fn is_extended(&self, own: &Explanation, table: Table) -> bool {
        let structure = own.fitted.point.structure();
        let mut all = self.extended.iter();
        all.any(|(own, by)| *own == structure && *by == table)
    }

    /// How often a structure was extended.
    pub fn extended(&self) -> usize {
        self.extended.len()
    }

    /// Chi-squared per row, at least 1, of the explanation that leaves least, over fitted rows and held-out
    /// rows (those beyond the errors of the fit).
    pub fn unit(&self, judge: &Judge) -> f64 {
        unit(self.least(), judge)
    }

    /// Temperature of the evidence: [`CALIBRATED`] times the size and correlation of the noise, plus a possible
    /// error of the laws. The latter is up to a share [`DISCREPANCY`] of what they explain, with the same
    /// correlation.
    ///
    /// The noise lies between two residuals: that of the simplest explanation that leaves only noise, which may
    /// hide a small effect, and that of the explanation that leaves least, which may have fitted noise. Their
    /// geometric mean is taken.
    pub fn temperature(&self, judge: &Judge) -> f64 {
        let (first, least) = (self.baseline(), self.least());
        let noise = |own: &Explanation| unit(own, judge) * own.evidence.correlation();
        let noise = (noise(self.simplest(judge)) * noise(least)).sqrt();
        let explained = (left(first) - left(least)).max(0.0) / rows(judge);
        let wrong = (DISCREPANCY.powi(2) * explained).min(unit(least, judge) - 1.0);
        CALIBRATED * noise + wrong * first.evidence.correlation()
    }

    /// The explanation with the least residual.
    fn least(&self) -> &Explanation {
        let all = self.all.iter().map(|entry| &entry.own);
        let least = all.min_by(|a, b| left(a).total_cmp(&left(b)));
        least.unwrap_or(self.baseline())
    }

    /// The simplest explanation that leaves only noise; if there is none, the one that leaves least.
    fn simplest(&self, judge: &Judge) -> &Explanation {
        let all = self.all.iter().map(|entry| &entry.own);
        let noise = all.filter(|own| judge.leaves_noise(own));
        let order = |own: &&Explanation| own.terms();
        noise.min_by_key(order).unwrap_or(self.least())
    }

    /// All structures, each at its likeliest resolution, with their log marginal likelihoods, the most probable first. Those with
    /// a parameter that says nothing come last.
    pub fn ranked(&self, temperature: f64) -> Vec<(&Explanation, f64)> {
        let scored = |entry: &'_ Entry| entry.own.log_evidence(temperature);
        let mut ranked: Vec<(&Explanation, f64)> = self
            .all
            .iter()
            .map(|entry| (&entry.own, scored(entry)))
            .collect();
        let order = |own: &(&Explanation, f64)| (own.0.is_meaningless, -own.1);
        ranked.sort_by(|a, b| order(a).partial_cmp(&order(b)).unwrap_or(Ordering::Equal));
        let mut learned: Vec<&Explanation> = Vec::new();
        ranked.retain(|(own, _)| {
            let is_first = !own.is_learned() || !learned.iter().any(|other| other.is_like(own));
            learned.extend(own.is_learned().then_some(*own));
            is_first
        });
        ranked
    }
}

/// Chi-squared of an explanation's residual.
fn left(own: &Explanation) -> f64 {
    own.evidence.left() + own.evidence.held_out_beyond_fit()
}

/// The same per row, at least 1.
fn unit(own: &Explanation, judge: &Judge) -> f64 {
    (left(own) / rows(judge)).max(1.0)
}

/// Number of these rows.
fn rows(judge: &Judge) -> f64 {
    (judge.train_rows + judge.held_out_rows).max(1) as f64
}

//! The search for missing effects: a beam of structures. Each is extended, thinned out and changed as long as
//! the evidence rises.

use super::candidate::Known;
use super::explanation::Explanation;
use super::judge::Judge;
use super::point::Point;
use super::pool::Pool;
use super::problem::Problem;
use super::projector::Projector;
use super::screen::Table;
use super::thresholds::{BEAM, LONG, MOST_EFFECTS};
use rayon::prelude::*;
use std::sync::atomic::Ordering::Relaxed;

/// Work, in simulated steps, after which the search ends with the best explanation so far: some fifty seconds
/// on one core.
const ENOUGH: u64 = 100_000_000;

/// Inputs of the search.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    /// The problem.
    pub problem: &'a Problem<'a>,
    /// Projects its linear nuisances out.
    pub projector: &'a Projector,
    /// Judges its fits.
    pub judge: &'a Judge<'a>,
    /// Explanations from another look at the same recordings.
    pub known: &'a Known,
    /// Callback for progress: the finished share, 0 to 1, and the present step.
    pub progress: &'a (dyn Fn(f64, &str) + Sync),
}

impl Search<'_> {
    /// A structure, fitted from a point and judged.
    pub fn refitted(&self, point: &Point) -> Explanation {
        let fitted = self.problem.fit(point, self.projector, LONG);
        self.judge.judge(self.problem, self.projector, fitted)
    }

    /// Extends the best structures of each size until nothing raises the evidence. Laws of the catalogue come
    /// first: before their structures are complete, learned laws would outrank them.
    pub fn run(&self, pool: &mut Pool) {
        loop {
            while self.fit_to_all_rows(pool) || self.join_in_curve(pool) || self.grow(pool, 1) {}
            if self.exchange(pool) {
                continue;
            }
            while self.grow(pool, BEAM) {}
            let is_better = self.learn(pool)
                || self.learn_from_named(pool)
                || self.name(pool)
                || self.exchange(pool)
                || self.look_ahead(pool)
                || self.exchange_credible(pool)
                || self.join(pool);
            if !is_better {
                return;
            }
            if self.is_over() {
                pool.is_unfinished |= self.next(pool, BEAM).is_some();
                return;
            }
        }
    }

    /// Whether the search is to end.
    pub fn is_over(&self) -> bool {
        self.problem.is_cut() || self.problem.simulated.load(Relaxed) > ENOUGH
    }

    /// Extends the next structure of a pool by laws of the catalogue; returns whether there was one.
    pub fn grow(&self, pool: &mut Pool, beam: usize) -> bool {
        let Some(next) = self.next(pool, beam) else {
            return false;
        };
        if pool.is_extended(pool.baseline(), Table::Named) && self.is_over() {
            pool.is_unfinished = true;
            return false;
        }
        (self.progress)(0.5, "looking for a further effect");
        // Where only noise is left there will be no third law, which a learned one should precede.
        let part = (!self.leaves_noise(&next)).then(|| next_to_learn(pool, &next));
        match part.flatten() {
            Some(part) => self.extend_by(pool, &part, Table::Learned),
            None => self.extend_by(pool, &next, Table::Named),
        }
        true
    }

    /// Extends a structure of a pool by the laws of a table.
    pub fn extend_by(&self, pool: &mut Pool, own: &Explanation, table: Table) {
        self.add_extended(pool, own, table);
        self.thin_out(pool);
    }

    /// The same without thinning out.
    pub fn add_extended(&self, pool: &mut Pool, own: &Explanation, table: Table) {
        if !self.problem.is_cut() {
            let children = self.extend(own, table, pool);
            children.into_iter().for_each(|child| pool.add(child));
        }
        pool.mark(own, table);
    }

    /// Searches a learned law beside those of the best explanation, if that leaves more than noise. Also
    /// searches one in place of several laws of the catalogue, which may be parts of one curve. Returns whether
    /// there is a better explanation.
    fn learn(&self, pool: &mut Pool) -> bool {
        let before = pool.best(self.judge).clone();
        let baseline = pool.baseline().clone();
        let is_over = self.is_over() && pool.is_extended(&baseline, Table::Learned);
        for own in [baseline, before.clone()] {
            let best = pool.best(self.judge);
            let needed = !self.leaves_noise(best) || own.terms() == 0 && best.terms() > 1;
            if needed {
                self.extend_new(pool, &own, Table::Learned, is_over);
            }
        }
        !pool.best(self.judge).is_like(&before)
    }

    /// The next structure to extend. Structures of named laws come first: before they are complete, learned
    /// laws would outrank them. A structure with a learned law follows only if it is the best of all.
    fn next(&self, pool: &Pool, beam: usize) -> Option<Explanation> {
        let ranked = pool.ranked(pool.temperature(self.judge));
        let (learned, named): (Vec<_>, Vec<_>) = ranked.iter().partition(|own| own.0.is_learned());
        let best = ranked[0].0;
        // If only noise is left, nothing masks a further effect.
        let is_left = !self.leaves_noise(best);
        let beam = if is_left { beam } else { 1 };
        // If no single effect is worth it, two together may be.
        let ahead = usize::from(is_left && best.terms() == 0);
        let next = match best.is_learned() && !is_left {
            true => None,
            false => open(pool, &named, (beam, ahead)),
        };
        next.or_else(|| {
            best.is_learned()
                .then(|| open(pool, &learned, (1, 0)))
                .flatten()
        })
    }

    /// Drops from the best explanation every term without which the evidence is no less, or puts a simpler law in its place
    /// that it contains, or fits its laws with and without the parameters that they may be without. The explanation of the
    /// highest evidence is treated so first, even with a parameter at the end of its range. Structures without a term are fitted
    /// again from here: the term may have led the others out of a false minimum.
    pub fn thin_out(&self, pool: &mut Pool) {
        while !self.problem.is_cut()
            && let Some(own) = pool.next_to_thin_out(self.judge)
        {
            let point = &own.fitted.point;
            let terms: Vec<usize> = (point.given_terms..point.terms.len()).collect();
            let simpler = terms.into_par_iter().flat_map_iter(|term| {
                let limits = self.limits_of(point, term);
                std::iter::once(point.without(term)).chain(limits)
            });
            let simpler = simpler.chain(self.problem.simpler(point));
            let simpler: Vec<Explanation> = simpler.map(|point| self.refitted(&point)).collect();
            simpler.into_iter().for_each(|next| pool.add(next));
            pool.add(self.in_full(own, |_| true));
        }
    }

    /// Chooses each effect of the best explanation again beside the others. If it has a learned law, named laws
    /// in its place are tried, too: the learned law may stand for two laws that move together. Returns whether
    /// there is a better explanation.
    fn exchange(&self, pool: &mut Pool) -> bool {
        let best = pool.best(self.judge).clone();
        self.exchange_in(pool, &best);
        if best.is_learned() {
            for own in pool.most_likely(best.terms()) {
                self.extend_new(pool, &own, Table::Named, self.is_over());
            }
        }
        !pool.best(self.judge).is_like(&best)
    }

    /// Chooses each effect of each credible explanation again: an effect that is wrong may be what hides another one. Returns
    /// whether there is a better explanation.
    fn exchange_credible(&self, pool: &mut Pool) -> bool {
        let best = pool.best(self.judge).clone();
        for own in pool.credible(self.judge) {
            self.exchange_in(pool, &own);
            if !pool.best(self.judge).is_like(&best) {
                return true;
            }
        }
        false
    }

    /// Chooses each effect of an explanation again beside the others.
    fn exchange_in(&self, pool: &mut Pool, own: &Explanation) {
        let point = &own.fitted.point;
        for term in point.given_terms..point.terms.len() {
            self.extend_part(pool, &point.without(term));
        }
    }

    /// Extends a part of a structure by laws of the catalogue, unless that was done, or the search is over.
    pub fn extend_part(&self, pool: &mut Pool, part: &Point) {
        let part = match pool.like(part).cloned() {
            Some(known) => known,
            None if self.is_over() => {
                pool.is_unfinished = true;
                return;
            }
            None => {
                let fitted = self.refitted(part);
                pool.add(fitted.clone());
                fitted
            }
        };
        self.extend_new(pool, &part, Table::Named, self.is_over());
    }

    /// Extends a structure by the laws of a table, unless that was done, or the search is over.
    pub fn extend_new(&self, pool: &mut Pool, own: &Explanation, table: Table, is_over: bool) {
        match pool.is_extended(own, table) {
            true => {}
            false if is_over => pool.is_unfinished = true,
            false => self.extend_by(pool, own, table),
        }
    }
}

/// The first structure that is to have a learned law before this one has a further effect: one law of any shape is a simpler
/// explanation than three of the catalogue, and one beside others is simpler than two beside them.
pub fn next_to_learn(pool: &Pool, next: &Explanation) -> Option<Explanation> {
    let point = &next.fitted.point;
    if next.terms() < 2 {
        return None;
    }
    let parts = (point.given_terms..point.terms.len()).map(|term| point.without(term));
    let known = parts.filter_map(|part| pool.like(&part));
    let mut all = std::iter::once(pool.baseline()).chain(known);
    all.find(|own| !own.is_learned() && !pool.is_extended(own, Table::Learned))
        .cloned()
}

/// The first structure, from few effects to many, that is in the beam of its number of effects and not extended
/// yet. The search goes on to more effects only while their best is not worse than with fewer; `ahead` effects
/// are always allowed.
fn open(
    pool: &Pool,
    ranked: &[(&Explanation, f64)],
    (beam, ahead): (usize, usize),
) -> Option<Explanation> {
    let mut least = f64::NEG_INFINITY;
    for count in 0..MOST_EFFECTS {
        let level = ranked.iter().filter(|own| own.0.terms() == count);
        let level: Vec<_> = level.take(beam).collect();
        let Some(best) = level.first() else {
            continue;
        };
        if best.1 < least && count > ahead {
            return None;
        }
        least = least.max(best.1);
        let open = level
            .iter()
            .find(|own| !pool.is_extended(own.0, Table::Named));
        if let Some((next, _)) = open {
            return Some((*next).clone());
        }
    }
    None
}

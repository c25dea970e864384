//! Learned laws in the place of named ones of the same slot, begun at their curve.
//!
//! A learned law that begins at the model as it was given may end in a false minimum: a curve that changes the frequency must
//! change it by the right amount at once. Named laws that leave little are near the right curve. Laws of drive and sensor change
//! no frequency.

use super::explanation::Explanation;
use super::law_band::still;
use super::point::{EffectAt, Point};
use super::pool::Pool;
use super::screen::{Table, candidates};
use super::search::Search;
use quell_model::Term;
use quell_model::curves::knots;
use quell_model::effects::{Effect, Slot, curve};
use rayon::prelude::*;

impl Search<'_> {
    /// Puts a learned law in the place of the named laws of each slot of the best explanation, where that leaves more than
    /// noise, or these are several. Returns whether there is a better explanation.
    pub fn learn_from_named(&self, pool: &mut Pool) -> bool {
        let best = pool.best(self.judge).clone();
        let least = if self.leaves_noise(&best) { 2 } else { 1 };
        self.learn_at_curves(pool, &best, least)
    }

    /// Puts a learned law in the place of several named ones of a slot before there is a further effect, even where a parameter
    /// of these is at the end of its range: they may be parts of one curve. Returns whether there is a better explanation.
    pub fn join_in_curve(&self, pool: &mut Pool) -> bool {
        let highest = pool.of_highest_evidence(self.judge).clone();
        self.learn_at_curves(pool, &highest, 2)
    }

    /// Adds learned laws in the place of the named ones of an explanation that are at least so many of a slot; once for each
    /// structure.
    fn learn_at_curves(&self, pool: &mut Pool, own: &Explanation, least: usize) -> bool {
        if self.problem.is_cut() || own.terms() < least || !pool.mark_learned_from(own, least) {
            return false;
        }
        let best = pool.best(self.judge).clone();
        let learned = candidates(self.problem, Table::Learned).into_par_iter();
        let starts = learned.flat_map_iter(|law| self.at_curves(own, law, least));
        let found: Vec<Explanation> = starts.map(|point| self.refitted(&point)).collect();
        found.into_iter().for_each(|own| pool.add(own));
        !pool.best(self.judge).is_like(&best)
    }

    /// An explanation with a learned law, at each of its resolutions, in the place of all its named laws of the same slot, if
    /// they are at least so many.
    fn at_curves(&self, own: &Explanation, (learned, place): EffectAt, least: usize) -> Vec<Point> {
        let point = &own.fitted.point;
        let is_named = |term: &Term| {
            let same = term.place == place && term.effect.slot() == learned.slot();
            same && !term.effect.is_learned() && !term.effect.happens()
        };
        let (named, others): (Vec<Term>, Vec<Term>) = point.terms[point.given_terms..]
            .iter()
            .cloned()
            .partition(is_named);
        let is_static = !learned.happens() && learned.slot() != Some(Slot::Hysteresis);
        if named.len() < least || !is_static || learned.acts_on_signal() {
            return Vec::new();
        }
        let mut rest = point.clone();
        rest.terms.truncate(point.given_terms);
        rest.terms.extend(others);
        let with = |effect: &'static Effect| {
            let values = self.on_curve(&named, effect, point)?;
            Some(rest.with(Term::new(effect, place, values)))
        };
        learned.resolutions().filter_map(with).collect()
    }

    /// Values of a learned law whose curve is the sum of those of named laws.
    fn on_curve(&self, named: &[Term], learned: &'static Effect, from: &Point) -> Option<Vec<f64>> {
        let scales = &self.problem.scales;
        let mut values = learned.starts_at(named[0].place, scales).swap_remove(0);
        let knots = knots(learned, &values);
        let at = still(self.problem, from);
        for term in named {
            let own = curve(term.effect, &term.values, &at, &knots)?;
            values
                .iter_mut()
                .zip(own)
                .for_each(|(sum, own)| *sum += own);
        }
        for ((value, x), parameter) in values.iter_mut().zip(&knots).zip(learned.parameters) {
            // The ordinates of friction are its levels.
            if learned.slot() == Some(Slot::Friction) {
                *value *= x.signum();
            }
            let (low, high) = (parameter.bounds)(scales);
            *value = value.clamp(low, high);
        }
        Some(values)
    }
}

//! Names for learned laws: each named law of the slot, and the best sums of two, started where they are nearest to the learned
//! curve.

use super::curves::ordinates;
use super::explanation::Explanation;
use super::law_band::still;
use super::point::{Global, Point};
use super::pool::Pool;
use super::problem::Problem;
use super::search::Search;
use super::thresholds::BEAM;
use nalgebra::DMatrix;
use quell_model::Term;
use quell_model::curves::{Curve, NamedLaws};
use quell_model::effects::Effect;
use rayon::prelude::*;

impl Search<'_> {
    /// Replaces the learned laws of the best explanation by named ones. Returns whether there is a better
    /// explanation.
    pub fn name(&self, pool: &mut Pool) -> bool {
        if self.problem.is_cut() {
            return false;
        }
        let best = pool.best(self.judge).clone();
        let temperature = pool.temperature(self.judge);
        let point = &best.fitted.point;
        let added = point.given_terms..point.terms.len();
        let starts = added.flat_map(|term| self.named(&best, term, temperature));
        let starts: Vec<Point> = starts.filter(|point| pool.like(point).is_none()).collect();
        let fitted = starts.into_par_iter().map(|point| self.refitted(&point));
        for next in fitted.collect::<Vec<_>>() {
            pool.add(next);
        }
        !pool.best(self.judge).is_like(&best)
    }

    /// Points with a named law in the place of a learned one.
    fn named(&self, own: &Explanation, index: usize, temperature: f64) -> Vec<Point> {
        let (problem, point) = (self.problem, &own.fitted.point);
        let learned = &point.terms[index];
        let at = still(problem, point);
        let curve = covariance(own, index, temperature)
            .and_then(|known| Curve::new(learned.effect, &learned.values, &known, &at));
        let Some(curve) = curve else {
            return Vec::new();
        };
        let Problem {
            scales, catalogue, ..
        } = problem;
        let Some(laws) = NamedLaws::of(&curve, learned.place, &at, scales, *catalogue) else {
            return Vec::new();
        };
        let sums = laws.nearest_sums();
        let sums = sums.into_iter().take(BEAM).map(Vec::from);
        let others = point.without(index);
        let with = |laws: Vec<(&'static Effect, Vec<f64>)>| {
            laws.into_iter()
                .try_fold(others.clone(), |point, (effect, values)| {
                    let term = Term {
                        effect,
                        values,
                        ..learned.clone()
                    };
                    point
                        .has_room_for(term.identity())
                        .then(|| point.with(term))
                })
        };
        let single = laws
            .nearest()
            .into_iter()
            .map(|law| vec![(law.effect, law.values)]);
        single.chain(sums).filter_map(with).collect()
    }
}

/// Covariance of the ordinates of a learned law; `None` for another law.
fn covariance(own: &Explanation, index: usize, temperature: f64) -> Option<DMatrix<f64>> {
    let effect = own.fitted.point.terms[index].effect;
    if !effect.is_learned() {
        return None;
    }
    let ordinates = ordinates(effect);
    let is_ordinate = |global: &Global| matches!(*global, Global::Parameter(of, parameter) if of == index && ordinates.contains(&parameter));
    let globals = own.fitted.globals.iter().enumerate();
    let ours: Vec<usize> = globals
        .filter(|own| is_ordinate(own.1))
        .map(|own| own.0)
        .collect();
    let whole = own.evidence.covariance(temperature);
    let between = |i: usize, j: usize| whole[(ours[i], ours[j])];
    Some(DMatrix::from_fn(ours.len(), ours.len(), between))
}

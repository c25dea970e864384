//! Continuation over the sizes of an effect whose misfit has many minima. It finds starts that a screen does
//! not see, since a screen moves the other unknowns by one step only.
//!
//! Source: Allgower and Georg, Introduction to Numerical Continuation Methods (2003).

use super::candidate::Candidate;
use super::descent::Descent;
use super::explanation::Explanation;
use super::point::{EffectAt, Global, Point};
use super::screen::{Table, candidates};
use super::search::Search;
use super::successive_halving::Halving;
use super::thresholds::{LOST, SECOND, SHORT};
use quell_model::Term;

/// Steps of the model's keys at each size.
const FIRST: usize = 2;
/// Number of parts into which a step of the size is divided near the best one. Sizes then differ by some 15 %,
/// instead of 1.7 times as in a grid.
const SLOWER: u32 = 4;

impl Search<'_> {
    /// Starts by continuation, for all effects that need it. If nothing is left to be found, only those effects
    /// that take part in the halving are followed; in a look at what is known alone, only those that are known.
    pub(super) fn continued(&self, from: &Explanation, halving: &Halving) -> Vec<Candidate> {
        let own = from.effects();
        if self.problem.is_cut() {
            return Vec::new();
        }
        let done = halving.is_won() || self.leaves_noise(from);
        let asked = |effect: &EffectAt| match self.known.alone {
            true => self.known.extends(&from.fitted.point, *effect),
            false => halving.has(*effect) || !done,
        };
        let winding = |effect: &EffectAt| {
            effect.0.has_many_minima() && !own.contains(effect) && asked(effect)
        };
        let all = candidates(self.problem, Table::Named);
        let continued = all.into_iter().filter(winding);
        let candidate = |effect: EffectAt| Candidate {
            effect,
            near: Vec::new(),
            far: self.along_sizes(from, effect),
        };
        continued.map(candidate).collect()
    }

    /// The best points along the sizes of an effect, and along finer sizes around the best of these. At each
    /// size the model's keys are fitted, from their values at the previous size. A large effect changes them
    /// (the frequency, mostly), and a fit of keys and size at once would rather make the size small.
    fn along_sizes(&self, from: &Explanation, (effect, place): EffectAt) -> Vec<Point> {
        let lost = LOST * from.fitted.cost;
        let from = &from.fitted.point;
        let own = |parameter| Global::Parameter(from.terms.len(), parameter);
        let fitted = |mut point: Point, free: Option<usize>, steps| {
            let all = 0..effect.parameters.len();
            point.held = all.filter(|own| Some(*own) != free).map(own).collect();
            let mut descent = Descent::new(self.problem, self.projector, &point, None);
            descent.run(steps);
            let (cost, mut point) = (descent.cost(), descent.end().point);
            point.held.clear();
            (cost, point)
        };
        let step = |last: &Point, values: &[f64]| {
            let term = Term::new(effect, place, values.to_vec());
            fitted(last.with(term), None, FIRST)
        };
        let follow = |start: &Point, sizes: &[Vec<f64>]| {
            let mut ends: Vec<(f64, Point)> = Vec::new();
            for values in sizes {
                let last = ends.last();
                let last = last.map_or(start.clone(), |(_, end)| end.without(from.terms.len()));
                ends.push(step(&last, values));
                let is_lost = ends.last().is_some_and(|(cost, _)| *cost > lost);
                if is_lost || self.problem.is_cut() {
                    break;
                }
            }
            ends
        };
        let starts = (effect.starts)(&self.problem.scales);
        let mut ends = follow(from, &starts);
        let best = (0..ends.len()).min_by(|a, b| ends[*a].0.total_cmp(&ends[*b].0));
        let before = best.unwrap_or(0).saturating_sub(1);
        let nearer = between(&starts[before..ends.len().min(before + 3)], effect.size());
        ends.extend(follow(&ends[before].1.without(from.terms.len()), &nearer));
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.truncate(SECOND);
        // The size is fitted first. Parameters of the law's shape would otherwise compensate for a wrong size.
        let sized = |(_, end)| fitted(end, Some(effect.size()), SHORT).1;
        ends.into_iter().map(sized).collect()
    }
}

/// Sizes between those of a grid; the other values are those of the smaller one. `size` is the index of the
/// size.
fn between(starts: &[Vec<f64>], size: usize) -> Vec<Vec<f64>> {
    let part = |pair: &[Vec<f64>], k: u32| {
        let mut values = pair[0].clone();
        values[size] *= (pair[1][size] / pair[0][size]).powf(f64::from(k) / f64::from(SLOWER));
        values
    };
    let parts = |pair| (1..SLOWER).map(move |k| part(pair, k));
    starts.windows(2).flat_map(parts).collect()
}

//! Candidates on top of an explanation: screened, fitted in a race, and ranked.

use super::descent::Descent;
use super::explanation::Explanation;
use super::fit::Linearised;
use super::problem::{Global, Point};
use super::screen::{Start, candidates, screen};
use super::search::{GATE, LONG, STRONG, Search, Trial, ratio, sort};
use crate::effects::{Effect, Place, has_many_minima};
use rayon::prelude::*;

/// Candidates that are fitted after the screen.
const FITTED: usize = 10;
/// Sizes of each candidate that a fit starts from.
const SIZES: usize = 3;
/// Steps after which the better ones of these go on (successive halving: Jamieson and Talwalkar,
/// AISTATS 2016).
const FIRST: usize = 2;
/// How many go on.
const SECOND: usize = 2;
/// Steps after which the best of these is chosen.
const SHORT: usize = 6;
/// Parts into which the way from one size to the next is cut near the best one: sizes that differ by some 15 %
/// where a grid's differ by 1.7 times.
const SLOWER: u32 = 4;
/// Cost over that of the start of a walk, from which it has gone too far: twice the residual.
const LOST: f64 = 4.0;
/// Predicted fall of the cost below which a candidate is not fitted.
const HOPELESS: f64 = 6.0;

/// Explanations that were looked at elsewhere.
#[derive(Clone, Default)]
pub struct Known {
    /// Where they ended.
    pub points: Vec<Point>,
    /// Whether nothing else is to be looked at.
    pub alone: bool,
}

/// An effect at a place, and where its fit may start.
struct Candidate {
    effect: (&'static str, Place),
    /// Starts at the explanation that it extends, or near it.
    near: Vec<Point>,
    /// Starts elsewhere.
    far: Vec<Point>,
}

impl Search<'_> {
    /// Candidates on top of an explanation, fitted and judged against it; best first.
    pub fn extend(&self, from: &Explanation) -> Vec<Trial> {
        let (problem, projector) = (self.problem, self.projector);
        let linear = (!self.known.alone).then(|| problem.linearise(&from.fitted.point, projector));
        let mut found = Vec::new();
        if let Some(linear) = &linear {
            found = self.screened(from, linear);
        }
        self.add_known(from, &mut found);
        self.add_walked(from, &mut found);
        let begun: Vec<Descent> = found
            .into_par_iter()
            .filter_map(|candidate| self.begin(from, linear.as_ref(), candidate))
            .collect();
        let ahead = begun
            .iter()
            .map(Descent::cost)
            .fold(f64::INFINITY, f64::min);
        let mut trials: Vec<Trial> = begun
            .into_par_iter()
            .map(|descent| self.finish(descent, ahead))
            .collect();
        self.rank(from, &mut trials);
        trials
    }

    /// The best candidates of a screen.
    fn screened(&self, from: &Explanation, linear: &Linearised) -> Vec<Candidate> {
        let (problem, point) = (self.problem, &from.fitted.point);
        // A mismatch that the refitted keys have absorbed is found from what the engineer believes.
        let mut believed = point.clone();
        for &key in &problem.free {
            believed.keys[key] = problem.beliefs[key].0;
        }
        let starts = screen(problem, point, linear, self.projector, SIZES);
        let candidate = |starts: Vec<Start>| {
            let with = |from: &Point, s: &Start| from.with(s.effect, s.place, s.values.clone());
            let near = starts.iter().map(|start| with(point, start));
            let near = near.chain([with(&believed, &starts[0])]);
            Candidate {
                effect: (starts[0].effect.name, starts[0].place),
                near: near.collect(),
                far: Vec::new(),
            }
        };
        chosen(starts).into_iter().map(candidate).collect()
    }

    /// Adds starts from walks over the sizes of effects whose misfit has many minima, whatever the screen
    /// says: it moves the rest in one step only.
    fn add_walked(&self, from: &Explanation, found: &mut Vec<Candidate>) {
        let own = from.effects();
        for (effect, place) in candidates(self.problem) {
            let name = (effect.name, place);
            let there = found.iter().any(|candidate| candidate.effect == name);
            let winding = has_many_minima(effect.name) && !own.contains(&name);
            if winding && (there || !self.known.alone) {
                add_far(found, name, self.walked(from, effect, place));
            }
        }
    }

    /// The best places on a walk over the sizes of an effect, and on a slower one around the best of these.
    /// At each size the model's keys are fitted from where they were at the last one: a large size makes them
    /// (a frequency, mostly) other than they are without the effect, and a fit of both at once would rather
    /// make the size small. Sizes come first among an effect's parameters, and are above 0.
    ///
    /// Source: Allgower and Georg, Introduction to Numerical Continuation Methods (2003).
    fn walked(&self, from: &Explanation, effect: &'static Effect, place: Place) -> Vec<Point> {
        let lost = LOST * from.fitted.cost;
        let from = &from.fitted.point;
        let own = |parameter| Global::Parameter(from.terms.len(), parameter);
        let fitted = |mut point: Point, free: usize, steps| {
            point.held = (free..effect.parameters.len()).map(own).collect();
            let mut descent = Descent::new(self.problem, self.projector, &point, None);
            descent.run(steps);
            let (cost, mut point) = (descent.cost(), descent.end().point);
            point.held.clear();
            (cost, point)
        };
        let step = |last: &Point, values: &[f64]| {
            fitted(last.with(effect, place, values.to_vec()), 0, FIRST)
        };
        let walk = |start: &Point, sizes: &[Vec<f64>]| {
            let mut ends: Vec<(f64, Point)> = Vec::new();
            for values in sizes {
                let last = ends.last();
                let last = last.map_or(start.clone(), |(_, end)| end.without(from.terms.len()));
                ends.push(step(&last, values));
                if ends.last().is_some_and(|(cost, _)| *cost > lost) {
                    break;
                }
            }
            ends
        };
        let starts = (effect.starts)(&self.problem.scales);
        let mut ends = walk(from, &starts);
        let best = (0..ends.len()).min_by(|a, b| ends[*a].0.total_cmp(&ends[*b].0));
        let before = best.unwrap_or(0).saturating_sub(1);
        let nearer: Vec<Vec<f64>> = between(&starts[before..ends.len().min(before + 3)]);
        ends.extend(walk(&ends[before].1.without(from.terms.len()), &nearer));
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.truncate(SECOND);
        // The size first, then what shapes the law: it makes up for a size that is not yet right.
        let sized = |(_, end)| fitted(end, 1, SHORT).1;
        ends.into_iter().map(sized).collect()
    }

    /// What is known with one effect more than the explanation has.
    fn add_known(&self, from: &Explanation, found: &mut Vec<Candidate>) {
        let own = from.effects();
        for known in &self.known.points {
            let added = known.terms[known.given_terms..].iter();
            let theirs: Vec<_> = added.map(|t| (t.effect.name, t.place)).collect();
            let new: Vec<_> = theirs.iter().filter(|e| !own.contains(e)).collect();
            let &[&effect] = new.as_slice() else { continue };
            if theirs.len() != own.len() + 1 {
                continue;
            }
            let point = Point {
                locals: from.fitted.point.locals.clone(),
                ..known.clone()
            };
            add_far(found, effect, vec![point]);
        }
    }

    /// Judges fits against the explanation that they extend; best first.
    pub(super) fn rank(&self, from: &Explanation, trials: &mut [Trial]) {
        let unit = trials
            .iter()
            .map(|trial| self.unit(&trial.explanation))
            .fold(self.unit(from), f64::min);
        for trial in trials.iter_mut() {
            let change = self.criterion(&trial.explanation) - self.criterion(from);
            trial.delta_bic = change / unit;
            trial.held_out_ratio = ratio(trial.explanation.held_out, from.held_out);
            // As many sizes as were looked at, so many chances had noise (a Bonferroni bound on 2 ln L).
            let looks = trial.explanation.looks(&self.problem.scales) as f64;
            let certain = trial.delta_bic < -STRONG - 2.0 * looks.ln();
            trial.passed = certain && trial.held_out_ratio < GATE;
        }
        sort(trials);
        trials.iter().for_each(|trial| self.log(trial));
    }

    /// For who wants to follow the search.
    fn log(&self, trial: &Trial) {
        let own = &trial.explanation;
        let over_noise = |chi: f64, rows: usize| (chi / rows.max(1) as f64).sqrt();
        let terms = own.fitted.point.terms.iter();
        let values: Vec<&[f64]> = terms.map(|term| &term.values[..]).collect();
        tracing::debug!(
            effects = ?own.effects(),
            ?values,
            keys = ?own.fitted.point.keys,
            delta_bic = trial.delta_bic,
            held_out_ratio = trial.held_out_ratio,
            passed = trial.passed,
            fitted_over_noise = over_noise(own.train, self.judge.train_rows),
            held_out_over_noise = over_noise(own.held_out, self.judge.held_out_rows),
            "candidate"
        );
    }

    /// The best of a candidate's starts, on its way.
    fn begin(
        &self,
        from: &Explanation,
        linear: Option<&Linearised>,
        candidate: Candidate,
    ) -> Option<Descent<'_>> {
        let begin = |point: &Point, near| {
            let mut descent = Descent::new(self.problem, self.projector, point, near);
            descent.run(FIRST);
            descent
        };
        let near = candidate.near.iter().map(|point| begin(point, linear));
        let far = candidate.far.iter().map(|point| begin(point, None));
        let mut descents: Vec<Descent> = near.chain(far).collect();
        descents.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        descents.truncate(SECOND);
        descents.iter_mut().for_each(|descent| descent.run(SHORT));
        let best = descents.into_iter();
        let best = best.min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
        (best.cost() <= from.fitted.cost).then_some(best)
    }

    /// A fit carried to its end, or to where the one ahead cannot be reached any more; judged.
    fn finish(&self, mut descent: Descent, ahead: f64) -> Trial {
        descent.race(LONG, ahead);
        if descent.winds() && descent.cost() < LOST * ahead {
            descent.hop();
        }
        Trial {
            explanation: self.judge.judge(self.problem, descent.end()),
            delta_bic: 0.0,
            held_out_ratio: 1.0,
            passed: false,
        }
    }
}

/// Sizes between those of a grid, the other values as they are.
fn between(sizes: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let part = |pair: &[Vec<f64>], k: u32| {
        let mut values = pair[0].clone();
        values[0] *= (pair[1][0] / pair[0][0]).powf(f64::from(k) / f64::from(SLOWER));
        values
    };
    let parts = |pair| (1..SLOWER).map(move |k| part(pair, k));
    sizes.windows(2).flat_map(parts).collect()
}

/// Adds starts elsewhere to those of an effect.
fn add_far(found: &mut Vec<Candidate>, effect: (&'static str, Place), mut far: Vec<Point>) {
    match found
        .iter_mut()
        .find(|candidate| candidate.effect == effect)
    {
        Some(candidate) => candidate.far.append(&mut far),
        None => found.push(Candidate {
            effect,
            near: Vec::new(),
            far,
        }),
    }
}

/// Starts of the best candidates, those of one effect and place together.
fn chosen(starts: Vec<Start>) -> Vec<Vec<Start>> {
    let mut groups: Vec<Vec<Start>> = Vec::new();
    for start in starts {
        if start.score < HOPELESS {
            break;
        }
        let same = |group: &&mut Vec<Start>| {
            let first: (&str, Place) = (group[0].effect.name, group[0].place);
            first == (start.effect.name, start.place)
        };
        let room = groups.len() < FITTED;
        match groups.iter_mut().find(same) {
            Some(group) => group.push(start),
            None if room => groups.push(vec![start]),
            None => {}
        }
    }
    groups
}

//! Candidates on top of an explanation: screened, fitted in a race, and ranked.

use super::descent::Descent;
use super::explanation::Explanation;
use super::fit::Linearised;
use super::problem::Point;
use super::screen::{Start, screen};
use super::search::{GATE, LONG, STRONG, Search, Trial, ratio, sort};
use crate::effects::Place;
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
/// Predicted fall of the cost below which a candidate is not fitted.
const HOPELESS: f64 = 6.0;

impl Search<'_> {
    /// Candidates on top of an explanation, fitted and judged against it; best first.
    pub fn extend(&self, from: &Explanation) -> Vec<Trial> {
        let (problem, projector) = (self.problem, self.projector);
        let linear = problem.linearise(&from.fitted.point, projector);
        let starts = screen(problem, &from.fitted.point, &linear, projector, SIZES);
        let begun: Vec<Descent> = chosen(starts)
            .into_par_iter()
            .filter_map(|starts| self.begin(from, &linear, &starts))
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
    }

    /// The best of a candidate's starts, on its way.
    fn begin(
        &self,
        from: &Explanation,
        linear: &Linearised,
        starts: &[Start],
    ) -> Option<Descent<'_>> {
        let (problem, projector) = (self.problem, self.projector);
        // A mismatch that the refitted keys have absorbed is found from what the engineer believes.
        let mut believed = from.fitted.point.clone();
        for &key in &problem.free {
            believed.keys[key] = problem.beliefs[key].0;
        }
        let begin = |(start, point): (&Start, &Point)| {
            let point = point.with(start.effect, start.place, start.values.clone());
            let mut descent = Descent::new(problem, projector, &point, Some(linear));
            descent.run(FIRST);
            descent
        };
        let starts = starts
            .iter()
            .flat_map(|start| [(start, &from.fitted.point), (start, &believed)]);
        let mut descents: Vec<Descent> = starts.map(begin).collect();
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
        Trial {
            explanation: self.judge.judge(self.problem, descent.end()),
            delta_bic: 0.0,
            held_out_ratio: 1.0,
            passed: false,
        }
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

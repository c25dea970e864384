//! The search for what is missing: screen, fit, decide; once more on the better model; prune.

use super::criteria::{Search, ratio, sort};
use super::descent::Descent;
use super::explanation::Explanation;
use super::found::{Found, Trial};
use super::point::Point;
use super::quality::quality;
use super::thresholds::{GATE, LONG, MOST_EFFECTS, SHAPE, STRONG};
use rayon::prelude::*;

/// Held-out chi-squared of an effect over that without it, above which it is not believed, where the model alone is
/// already at the floor: a part of the noise that is no larger than the
/// uncertainty of its level (a twentieth in amplitude) is not called physics.
const WEAK: f64 = 0.9;
/// Share of what an effect leaves, in energy, that a further one must explain where the first left less
/// than its shape could be wrong: the larger part.
const MOST: f64 = 0.5;
/// Explanations that are carried on.
const BEAM: usize = 2;
/// Two predictions whose sums of squares differ by less, fitted and held out, are taken for one.
const ALIKE: f64 = 0.005;

impl Search<'_> {
    /// The same fits, refitted and ranked where the noise was measured anew.
    pub fn again(&self, baseline: &Explanation, trials: Vec<Trial>) -> Vec<Trial> {
        let refit = |mut trial: Trial| {
            let point = &trial.explanation.fitted.point;
            let mut descent = Descent::new(self.problem, self.projector, point, None);
            descent.run(LONG);
            if trial.passed && descent.winds() {
                descent.hop();
            }
            trial.explanation = self.judge.judge(self.problem, descent.end());
            trial
        };
        let mut trials: Vec<Trial> = trials.into_par_iter().map(refit).collect();
        self.rank(baseline, &mut trials);
        trials
    }

    /// Searches on from the refitted model and the single effects that it may lack.
    pub fn run(&self, baseline: Explanation, mut trials: Vec<Trial>) -> Found {
        let plain = |trial: &Trial| trial.passed && trial.held_out_ratio < WEAK;
        if self.at_floor(&baseline) && !trials.iter().any(plain) {
            trials.iter_mut().for_each(|trial| trial.passed = false);
        }
        let mut frontier: Vec<Explanation> = passed(&trials, BEAM);
        let mut best = self
            .simplest(&trials, &baseline)
            .unwrap_or_else(|| baseline.clone());
        if !frontier.is_empty() && frontier[0].effects() != best.effects() {
            frontier.insert(0, best.clone());
            frontier.truncate(BEAM);
        }
        let mut pool = trials.clone();
        best = self.grown(&baseline, best, frontier, &mut pool);
        best = self.exchanged(best, &mut pool);
        best = self.simplified(&baseline, best);
        best = self.flexibility(&best, &pool).cloned().unwrap_or(best);
        best = self.taken_apart(best);
        let better = |trial: &&mut Trial| {
            trial.explanation.is_like(&best)
                && self.criterion(&trial.explanation) > self.criterion(&best)
        };
        if let Some(trial) = trials.iter_mut().find(better) {
            trial.explanation = best.clone();
        }
        let unit = self.unit(&best);
        for trial in trials.iter_mut().chain(&mut pool) {
            let change = self.criterion(&trial.explanation) - self.criterion(&baseline);
            trial.delta_bic = change / unit;
            trial.held_out_ratio = ratio(trial.explanation.held_out, baseline.held_out);
        }
        sort(&mut pool);
        sort(&mut trials);
        let equals = self.equals(&best, &pool, unit);
        let ablated = self.ablated(&best, &baseline);
        Found {
            ablated,
            baseline,
            best,
            equals,
            further: several(&pool),
            trials,
            unit,
        }
    }

    /// The best explanation with further effects, as long as more than noise is left. Where one of these leads
    /// another to a better minimum and is not needed there, that one is extended in its turn.
    fn grown(
        &self,
        baseline: &Explanation,
        mut best: Explanation,
        mut frontier: Vec<Explanation>,
        pool: &mut Vec<Trial>,
    ) -> Explanation {
        while !frontier.is_empty() && !self.all_at_noise(&best) {
            (self.progress)(0.5, "looking for a further effect");
            let further: Vec<Trial> = frontier.iter().flat_map(|own| self.extend(own)).collect();
            let sound = further.iter().filter(|trial| trial.passed);
            // Against one another: each was ranked against the explanation that it extends.
            let first = self.lowest(sound.map(|trial| &trial.explanation));
            let pruned = first.map(|first| self.prune(first.clone()));
            pool.extend(further);
            frontier.clear();
            let better = |next: &Explanation| {
                self.criterion(next) < self.criterion(&best) - STRONG * self.unit(next)
                    && self.worth(baseline, &best, next)
            };
            if let Some(next) = pruned.filter(better) {
                if next.effects().len() < MOST_EFFECTS {
                    frontier.push(next.clone());
                }
                best = next;
            }
        }
        best
    }

    /// Whether a second effect is a mechanism of its own rather than compensation for an error of the first law's
    /// shape. The residual must fall by more than that shape could be wrong, or by more than half, on the fitted and
    /// on the held-out part. The held-out part must also be predicted better as it was recorded, not only whitened.
    fn worth(&self, baseline: &Explanation, best: &Explanation, next: &Explanation) -> bool {
        let (rows, held) = (self.judge.train_rows, self.judge.held_out_rows);
        let reach = SHAPE * (baseline.train - rows as f64);
        let most = |before: f64, after: f64, rows: usize| {
            before - after > MOST * (before - rows as f64).max(0.0)
        };
        let all = most(best.train, next.train, rows) && most(best.held_out, next.held_out, held);
        // A second sensor may show what the first one does not.
        let several = self.problem.experiments[0].outputs.len() > 1;
        let raw = |explanation| quality(self, explanation).held_out_rms;
        let better = || several || raw(next).powi(2) < GATE * raw(best).powi(2);
        (best.train - next.train > reach || all) && better()
    }

    /// The explanation without each of its effects, refitted.
    fn ablated(&self, best: &Explanation, baseline: &Explanation) -> Vec<Explanation> {
        let effects = best.effects();
        if effects.len() < 2 {
            return vec![baseline.clone(); effects.len()];
        }
        let without = |effect| self.refitted(&best.fitted.point.without_effect(effect));
        effects.into_iter().map(without).collect()
    }

    /// Drops every effect without which the held-out part is no worse.
    fn prune(&self, explanation: Explanation) -> Explanation {
        let mut best = explanation;
        loop {
            let effects = best.effects();
            if effects.len() < 2 {
                return best;
            }
            let unit = self.unit(&best);
            let point = &best.fitted.point;
            let dropped = effects
                .into_iter()
                .map(|effect| self.refitted(&point.without_effect(effect)))
                .filter(|without| {
                    let needless = self.criterion(without) < self.criterion(&best) + STRONG * unit;
                    // What was held out tells nothing where it was noise before.
                    let telling = !self.held_at_noise(without) || self.at_floor(without);
                    needless || telling && ratio(best.held_out, without.held_out) >= GATE
                })
                .min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)));
            match dropped {
                Some(without) => best = without,
                None => return best,
            }
        }
    }
}

/// The best that passed and predict differently: what predicts the same leaves the same to a further effect.
fn passed(trials: &[Trial], count: usize) -> Vec<Explanation> {
    let mut passed: Vec<Explanation> = Vec::new();
    for trial in trials.iter().filter(|trial| trial.passed) {
        let own = &trial.explanation;
        let alike = |other: &Explanation| {
            (own.train / other.train - 1.0).abs() < ALIKE
                && (ratio(own.held_out, other.held_out) - 1.0).abs() < ALIKE
        };
        if passed.len() < count && !passed.iter().any(alike) {
            passed.push(own.clone());
        }
    }
    passed
}

/// Where those of several effects ended that passed.
fn several(trials: &[Trial]) -> Vec<Point> {
    let ended = trials.iter().filter(|trial| trial.passed);
    let points = ended.map(|trial| &trial.explanation.fitted.point);
    let several = points.filter(|point| point.effects().len() > 1);
    several.cloned().collect()
}

//! Which of explanations that are nearly equal is told, and which are told beside it.

use super::explanation::Explanation;
use super::search::{EQUAL, GATE, MOST_EFFECTS, SHAPE, Search, Trial, ratio};
use crate::effects::{contains, parts};
use crate::model::Term;

impl Search<'_> {
    /// The best trial that passed; or one whose law is a limit of the best one's, if they differ by less
    /// than a law's shape could be wrong.
    pub(super) fn simplest(&self, trials: &[Trial], baseline: &Explanation) -> Option<Explanation> {
        let sound = || {
            trials
                .iter()
                .filter(|trial| trial.passed)
                .map(|trial| &trial.explanation)
        };
        let best = sound().min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)))?;
        let reach = SHAPE * (baseline.train - self.judge.train_rows as f64).max(0.0);
        let simpler = sound().find(|other| {
            let names = (best.effects(), other.effects());
            let limit = match (names.0.as_slice(), names.1.as_slice()) {
                ([own], [theirs]) => own.1 == theirs.1 && contains(own.0, theirs.0),
                _ => false,
            };
            limit && other.train <= best.train + reach
        });
        Some(simpler.unwrap_or(best).clone())
    }

    /// Explanations with as many effects as the best that are within reach of it.
    pub(super) fn equals(&self, best: &Explanation, pool: &[Trial], unit: f64) -> Vec<Trial> {
        let mut equals: Vec<Trial> = Vec::new();
        // Within a standard deviation of chi-squared two predictions are alike.
        let alike = 1.0 + (2.0 / self.judge.held_out_rows.max(1) as f64).sqrt();
        for trial in pool {
            let explanation = &trial.explanation;
            let worse = self.criterion(explanation) - self.criterion(best);
            let held = ratio(explanation.held_out, best.held_out);
            let limit = match (explanation.effects().as_slice(), best.effects().as_slice()) {
                ([theirs], [own]) => contains(theirs.0, own.0),
                _ => false,
            };
            // A law that contains the best one fits as well by itself: it is listed if it predicts better, or
            // if what it adds is worth its price (it was left out for being within reach of a law's shape).
            let close = match limit {
                true => worse < EQUAL * unit && held < GATE || worse < 0.0 && held < alike,
                false => worse < EQUAL * unit && held < alike,
            };
            let same = |other: &Trial| other.explanation.effects() == explanation.effects();
            let new = explanation.effects() != best.effects() && !equals.iter().any(same);
            if close && trial.passed && new && explanation.effects().len() <= best.effects().len() {
                equals.push(trial.clone());
            }
        }
        equals
    }

    /// An explanation whose law acts as two simpler ones together is told as these, where they do as well.
    pub(super) fn taken_apart(&self, best: Explanation) -> Explanation {
        let point = &best.fitted.point;
        if point.terms.len() - point.given_terms >= MOST_EFFECTS {
            return best;
        }
        for index in point.given_terms..point.terms.len() {
            let own = &point.terms[index];
            let Some(parts) = parts(own.effect.name, &own.values) else {
                continue;
            };
            if parts.iter().any(|part| !part.0.places.contains(&own.place)) {
                continue;
            }
            let mut apart = point.without(index);
            apart.terms.extend(parts.map(|(effect, values)| Term {
                effect,
                place: own.place,
                values,
            }));
            let apart = self.refitted(&apart);
            let close = self.criterion(&apart) < self.criterion(&best) + EQUAL * self.unit(&best);
            if close && ratio(apart.held_out, best.held_out) < 2.0 - GATE {
                return apart;
            }
        }
        best
    }
}

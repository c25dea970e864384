//! Which of explanations that are nearly equal is told, and which are told beside it.

use super::criteria::{Search, ratio};
use super::explanation::Explanation;
use super::found::Trial;
use super::screen::candidates;
use super::thresholds::{EQUAL, GATE, MOST_EFFECTS, SHAPE, STRONG};
use quell_model::Term;
use quell_model::effects::{Effect, Quantity};
use quell_recording::Role;

/// Fall of chi-squared that two needless parameters exceed once in twenty times (Wilks 1938).
const CHANCE: f64 = 6.0;

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
        let first = self.lowest(sound())?;
        // A law that must be stretched to the end of what is plausible stands in for another one.
        let level = self.criterion(first) + EQUAL * self.unit(first);
        let within =
            sound().filter(|other| self.criterion(other) < level && !self.is_stretched(other));
        let best = self.lowest(within).unwrap_or(first);
        let best = self.flexibility(best, trials).unwrap_or(best);
        let simpler = sound().find(|other| {
            let names = (best.effects(), other.effects());
            let limit = match (names.0.as_slice(), names.1.as_slice()) {
                ([own], [theirs]) => own.1 == theirs.1 && own.0.contains(theirs.0),
                _ => false,
            };
            limit && self.is_within_shape(baseline, best, other)
        });
        Some(simpler.unwrap_or(best).clone())
    }

    /// Whether another explanation leaves as much as one does, but for what the shape of a law could be wrong by, of
    /// what was fitted and of what was held out.
    fn is_within_shape(
        &self,
        baseline: &Explanation,
        own: &Explanation,
        other: &Explanation,
    ) -> bool {
        let (rows, held) = (
            self.judge.train_rows as f64,
            self.judge.held_out_rows as f64,
        );
        let reach = |mismatch: f64, rows: f64| SHAPE * (mismatch - rows).max(0.0);
        // Two predictions of the same part differ by chance, too.
        let chance = EQUAL * self.unit(own);
        other.train <= own.train + reach(baseline.train, rows)
            && other.held_out <= own.held_out + reach(baseline.held_out, held) + chance
    }

    /// Whether a parameter of an effect that was added lies within a thousandth of its range of a bound,
    /// other than the value at which it does nothing, and than the ends of a share or a side, which are
    /// laws of their own.
    fn is_stretched(&self, explanation: &Explanation) -> bool {
        let point = &explanation.fitted.point;
        point.terms[point.given_terms..].iter().any(|term| {
            let parameters = term.effect.parameters.iter().zip(&term.values);
            let mut ends = parameters.map(|(parameter, value)| {
                let (low, high) = (parameter.bounds)(&self.problem.scales);
                let near = |bound: f64| (value - bound).abs() < 1e-3 * (high - low);
                let whole =
                    |bound: f64| parameter.quantity == Quantity::NUMBER && bound.abs() == 1.0;
                [low, high]
                    .into_iter()
                    .any(|bound| bound != parameter.neutral && !whole(bound) && near(bound))
            });
            ends.any(|at_end| at_end)
        })
    }

    /// A sensor lag or a mode far above the motion in place of a gain of the deformation, where they fit about as
    /// well: a position sensor cannot scale the deformation by itself. A sensor that sees too little has a lag, which
    /// takes `(omega_n T)^2 / 2` beside its delay. One that sees too much shows a further mode (residual flexibility:
    /// Ewins, Modal Testing (2000), chapter 5).
    pub(super) fn flexibility<'t>(
        &self,
        best: &Explanation,
        pool: &'t [Trial],
    ) -> Option<&'t Explanation> {
        let outputs = &self.problem.experiments[0].outputs;
        let absolute = outputs
            .iter()
            .all(|output| output.role != Role::Deformation);
        let point = &best.fitted.point;
        let mut added = point.terms[point.given_terms..].iter();
        let gain = added.find(|term| term.effect.is_of_deformation_only())?;
        let too_little = gain.size() < 0.0;
        let near =
            |other: &&Explanation| other.fitted.cost < best.fitted.cost + CHANCE * self.unit(best);
        let sound = pool.iter().filter(|trial| absolute && trial.passed);
        let sound: Vec<_> = sound.map(|trial| &trial.explanation).filter(near).collect();
        let instead = |lag: bool| {
            let takes = |other: &&&Explanation| {
                substitution(best, other).is_some_and(|(own, theirs)| {
                    let stands_for = match lag {
                        true => theirs.lessens(own),
                        false => theirs.becomes(own),
                    };
                    own == gain.effect && stands_for
                })
            };
            self.lowest(sound.iter().filter(takes).copied())
        };
        let lag = too_little.then(|| instead(true)).flatten();
        lag.or_else(|| instead(false))
    }

    /// Explanations with as many effects as the best that are within reach of it.
    pub(super) fn equals(&self, best: &Explanation, pool: &[Trial], unit: f64) -> Vec<Trial> {
        let mut equals: Vec<Trial> = Vec::new();
        // Within a standard deviation of chi-squared two predictions are alike.
        let alike = 1.0 + (2.0 / self.judge.held_out_rows.max(1) as f64).sqrt();
        let as_many = |other: &&Explanation| other.effects().len() <= best.effects().len();
        let sound = pool.iter().filter(|trial| trial.passed);
        let sound = sound.map(|trial| &trial.explanation).filter(as_many);
        let level = self.criterion(best) + EQUAL * unit;
        let within = sound.filter(|other| self.criterion(other) < level);
        let within: Vec<&Explanation> = std::iter::once(best).chain(within).collect();
        for trial in pool {
            let explanation = &trial.explanation;
            let stands_in = || within.iter().any(|own| self.stands_in(own, explanation));
            let worse = self.criterion(explanation) - self.criterion(best);
            let held = ratio(explanation.held_out, best.held_out);
            let limit = match (explanation.effects().as_slice(), best.effects().as_slice()) {
                ([theirs], [own]) => theirs.0.contains(own.0),
                _ => false,
            };
            // A law that contains the best one always fits as well: it is listed if what it adds is more than
            // chance makes, or if it predicts better.
            let more = best.fitted.cost - explanation.fitted.cost > CHANCE * unit && held < alike;
            let near = worse < EQUAL * unit;
            let close = match limit {
                true => more || near && held < GATE,
                false => (near || stands_in()) && held < alike,
            };
            let same = |other: &Trial| other.explanation.is_like(explanation);
            let new = !explanation.is_like(best) && !equals.iter().any(same);
            if close && trial.passed && new && explanation.effects().len() <= best.effects().len() {
                equals.push(trial.clone());
            }
        }
        equals
    }

    /// Whether another explanation has a law that acts as a simpler one: the unknowns that it has besides are not
    /// determined, and do not count. As far as its descent came it may leave more, by what is chance.
    fn stands_in(&self, best: &Explanation, other: &Explanation) -> bool {
        let simpler = substitution(best, other).is_some_and(|(own, theirs)| theirs.becomes(own));
        simpler && other.fitted.cost < best.fitted.cost + CHANCE * self.unit(best)
    }

    /// A pair, each of its effects chosen anew beside the other: the first was chosen without the second. What is
    /// better by far is looked at in the same way; what does as well, on what was held out, too, takes its place or
    /// joins the pool.
    pub(super) fn exchanged(&self, mut best: Explanation, pool: &mut Vec<Trial>) -> Explanation {
        let (mut left, mut dropped) = (MOST_EFFECTS, 0);
        while left > 0 && best.effects().len() == MOST_EFFECTS {
            let effect = best.effects()[dropped];
            let kept = self.refitted(&best.fitted.point.without_effect(effect));
            let trials = self.extend(&kept);
            let fall = |next: &Explanation| self.criterion(&best) - self.criterion(next);
            let is_far = |next: &Explanation| fall(next) > STRONG * self.unit(next);
            let better = |next: &&Explanation| {
                let as_well = fall(next) > 0.0 && next.held_out <= best.held_out;
                (is_far(next) || as_well) && !next.is_like(&best)
            };
            let sound = trials.iter().filter(|trial| trial.passed);
            let next = self.lowest(sound.map(|trial| &trial.explanation).filter(better));
            let next = next.map(|next| (next.clone(), is_far(next)));
            pool.extend(trials);
            left -= 1;
            dropped += 1;
            if let Some((next, far)) = next {
                if far {
                    left = MOST_EFFECTS - 1;
                }
                // Of two, the one that was kept is the first now.
                (best, dropped) = (next, 0);
            }
        }
        best
    }

    /// A pair with the limits of its laws in their place, where these leave as much, but for what the shape of a
    /// law could be wrong by: beside another effect the simpler law may not have been looked at.
    pub(super) fn simplified(&self, baseline: &Explanation, mut best: Explanation) -> Explanation {
        let reach = SHAPE * (baseline.train - self.judge.train_rows as f64).max(0.0);
        let (train, held_out) = (best.train, best.held_out);
        let close = |other: &Explanation| {
            other.train <= train + reach && ratio(other.held_out, held_out) < 2.0 - GATE
        };
        let point = &best.fitted.point;
        let terms = match best.effects().len() {
            0 | 1 => 0..0,
            _ => point.given_terms..point.terms.len(),
        };
        for index in terms {
            let simpler = self.limits_of(&best, index).find(close);
            best = simpler.unwrap_or(best);
        }
        best
    }

    /// An explanation with the limits of the law of one of its terms in that one's place, refitted; none that it has already.
    fn limits_of(&self, from: &Explanation, index: usize) -> impl Iterator<Item = Explanation> {
        let point = &from.fitted.point;
        let own = &point.terms[index];
        let places = candidates(self.problem);
        own.effect.limits().filter_map(move |limit| {
            let there = || places.iter().filter(|other| other.0 == limit);
            let same = there().find(|other| other.1 == own.place);
            // Without a spring all forces act at one seat.
            let any = || there().next().filter(|_| self.problem.scales.rigid);
            let &(effect, place) = same.or_else(any)?;
            let twice = |term: &Term| term.identity() == (effect, place);
            if point.terms.iter().any(twice) {
                return None;
            }
            let typical = effect
                .parameters
                .iter()
                .map(|p| (p.typical)(&self.problem.scales));
            let mut start = point.clone();
            start.terms[index] = Term {
                effect,
                place,
                values: typical.collect(),
            };
            Some(self.refitted(&start))
        })
    }

    /// An explanation whose law acts as two simpler ones together is told as these, where they do as well.
    pub(super) fn taken_apart(&self, best: Explanation) -> Explanation {
        let point = &best.fitted.point;
        if best.effects().len() >= MOST_EFFECTS {
            return best;
        }
        for index in point.given_terms..point.terms.len() {
            let own = &point.terms[index];
            let Some(parts) = own.effect.parts(&own.values) else {
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

/// The effect of one explanation that another has another one for, and that one, where all others are the same.
fn substitution(
    own: &Explanation,
    other: &Explanation,
) -> Option<(&'static Effect, &'static Effect)> {
    let (own, theirs) = (own.effects(), other.effects());
    let mut gone = own.iter().filter(|effect| !theirs.contains(effect));
    let mut new = theirs.iter().filter(|effect| !own.contains(effect));
    match (gone.next(), gone.next(), new.next(), new.next()) {
        (Some(gone), None, Some(new), None) => Some((gone.0, new.0)),
        _ => None,
    }
}

//! The result of a search: the reported explanation, those that the data cannot tell from it, and the
//! probability of each effect.

use super::explanation::Explanation;
use super::figure::figure;
use super::point::{EffectAt, Global, Point};
use super::pool::Pool;
use super::search::Search;
use super::thresholds::{BARE_MENTION, CREDIBLE};
use super::units::{told_in, units};
use quell_model::Term;
use quell_model::effects::ParameterRole;
use std::f64::consts::TAU;

/// What a search found.
pub struct Found {
    /// The refitted model.
    pub baseline: Explanation,
    /// The reported explanation; the baseline where no effect is reported.
    pub best: Explanation,
    /// Others of the credible set, the most probable first.
    pub equals: Vec<Explanation>,
    /// The best explanation without each of its effects, refitted.
    pub ablated: Vec<Explanation>,
    /// All explanations of the search, the most probable first, each with its probability.
    pub ranked: Vec<(Explanation, f64)>,
    /// More probable explanations that are not reported, for what they predict or for their parameters.
    pub refused: Vec<Explanation>,
    /// Temperature of the evidence.
    pub temperature: f64,
    /// Whether the search was ended while there was more to try.
    pub is_unfinished: bool,
}

/// The reported explanation of a pool.
pub struct Told {
    /// The explanation; the baseline where no effect is reported.
    pub best: Explanation,
    /// The best explanation without each of its effects.
    ablated: Vec<Explanation>,
    /// More probable explanations that are not reported.
    refused: Vec<Explanation>,
}

impl Search<'_> {
    /// The conclusions from a pool.
    pub fn found(&self, mut pool: Pool) -> Found {
        let told = self.told(&mut pool);
        let temperature = pool.temperature(self.judge);
        let ranked = pool.ranked(temperature);
        let first = told.best.log_evidence(temperature);
        let weigh = |(own, log): (&Explanation, f64)| {
            let sound = self.refusal(&told.refused, temperature, own).is_none();
            (own.clone(), if sound { (log - first).exp() } else { 0.0 })
        };
        let mut ranked: Vec<(Explanation, f64)> = ranked.into_iter().map(weigh).collect();
        let all: f64 = ranked.iter().map(|own| own.1).sum();
        ranked.iter_mut().for_each(|own| own.1 /= all);
        Found {
            equals: credible(&ranked, &told.best),
            baseline: pool.baseline().clone(),
            best: told.best,
            ablated: told.ablated,
            ranked,
            refused: told.refused,
            temperature,
            is_unfinished: pool.is_unfinished,
        }
    }

    /// The most probable explanation that meets three conditions: its parameters are meaningful, it predicts
    /// the held-out rows better than the baseline, and none of its effects makes that prediction worse.
    pub fn told(&self, pool: &mut Pool) -> Told {
        loop {
            let known = pool.count();
            let told = self.first_sound(pool);
            // A refit without one of the effects may have found a better minimum than all fits before.
            if pool.count() == known {
                return told;
            }
        }
    }

    fn first_sound(&self, pool: &mut Pool) -> Told {
        let temperature = pool.temperature(self.judge);
        let ranked = self.simpler_first(&pool.ranked(temperature), temperature);
        let ranked = ranked.into_iter().take_while(|own| own.terms() > 0);
        let ranked: Vec<Explanation> = ranked.collect();
        let mut refused = Vec::new();
        for own in ranked {
            if own.held_out <= pool.baseline().held_out {
                // Without an effect whose parameter means nothing, its others may be told. The search has left that
                // behind, being less probable.
                let ablated = self.ablated(&own, pool);
                let worse = |without: &Explanation| {
                    let foreseen = |own: &Explanation| own.evidence.of_held_out(temperature);
                    let chance = |more: f64| more <= BARE_MENTION;
                    chance(foreseen(without) - foreseen(&own))
                        && chance(own.missed(temperature) - without.missed(temperature))
                };
                let meaningful = self.problem.is_meaningful(&own, temperature);
                if meaningful && ablated.iter().all(worse) {
                    return Told {
                        best: own,
                        ablated,
                        refused,
                    };
                }
            }
            refused.push(own);
        }
        Told {
            best: pool.baseline().clone(),
            ablated: Vec::new(),
            refused,
        }
    }

    /// Why an explanation has no probability, whatever its evidence; `None` where it has one. `refused` are those that are not
    /// reported.
    pub fn refusal(
        &self,
        refused: &[Explanation],
        temperature: f64,
        own: &Explanation,
    ) -> Option<String> {
        if let Some((term, index)) = own.at_end {
            let point = &own.fitted.point;
            let term = &point.terms[term];
            let parameter = &term.effect.parameters[index];
            let (factor, unit) = told_in(parameter, &units(self.problem, point));
            Some(format!(
                "the {} of {}, {}, is at the end of its range",
                term.effect.parameter_title(parameter.name),
                term.effect.title,
                figure(factor * term.values[index], &unit)
            ))
        } else if !self.problem.is_meaningful(own, temperature) {
            Some("a parameter may be anything within its range".into())
        } else if refused.iter().any(|other| other.is_like(own)) {
            Some(
                "it predicts what was held out worse than without it, or without one of its effects"
                    .into(),
            )
        } else {
            None
        }
    }

    /// An explanation without each of its effects, refitted.
    fn ablated(&self, own: &Explanation, pool: &mut Pool) -> Vec<Explanation> {
        let mut ablated = Vec::new();
        for effect in own.effects() {
            let point = own.fitted.point.without_effect(effect);
            let known = pool.like(&point).cloned();
            let known = known.unwrap_or_else(|| {
                let next = self.refitted(&point);
                pool.add(next.clone());
                next
            });
            ablated.push(known);
        }
        ablated
    }
}

/// The most probable explanations that hold, together with `best`, the share of the credible set. An
/// explanation that contains `best` does not contradict it and is left out: it has the same effects and more,
/// or laws that have them as limits, as Stribeck's friction has Coulomb's.
fn credible(ranked: &[(Explanation, f64)], best: &Explanation) -> Vec<Explanation> {
    let same = |own: &Explanation| contains(own, best);
    let mut held: f64 = ranked
        .iter()
        .filter(|own| same(&own.0))
        .map(|own| own.1)
        .sum();
    let mut set = Vec::new();
    for (own, weight) in ranked.iter().filter(|own| !same(&own.0)) {
        if held >= CREDIBLE {
            break;
        }
        held += weight;
        set.push(own.clone());
    }
    set
}

/// Whether an explanation has all effects of a simpler one, or laws that contain them as limits.
pub fn contains(own: &Explanation, simpler: &Explanation) -> bool {
    let own = own.effects();
    let mut simpler = simpler.effects().into_iter();
    simpler.all(|simple| own.iter().any(|law| is_or_contains(law, &simple)))
}

/// Whether a law is another one, or has it as a limit.
pub fn is_or_contains(law: &EffectAt, simple: &EffectAt) -> bool {
    law == simple || law.1 == simple.1 && law.0.contains(simple.0)
}

impl Found {
    /// The best explanation without one of its effects.
    pub fn without(&self, effect: EffectAt) -> &Explanation {
        let effects = self.best.effects();
        let index = effects.iter().position(|own| *own == effect);
        let ablated = index.and_then(|index| self.ablated.get(index));
        ablated.unwrap_or(&self.baseline)
    }

    /// Variance of a parameter about its value in the best explanation, over the explanations that have its
    /// effect.
    ///
    /// Source: Hoeting, Madigan, Raftery, Volinsky, Statistical Science 14 (1999), on the average over models.
    pub fn between(&self, global: Global) -> f64 {
        let Global::Parameter(index, parameter) = global else {
            return 0.0;
        };
        let own = &self.best.fitted.point.terms[index];
        let is_turn = own.effect.parameters[parameter].role == ParameterRole::Phase;
        let square = |(other, weight): &(Explanation, f64)| {
            let terms = &other.fitted.point.terms;
            // A learned law of another number of knots has other parameters.
            let is_like = |term: &&Term| {
                term.identity() == own.identity() && term.values.len() == own.values.len()
            };
            let like = terms.iter().find(is_like)?;
            let away = like.values[parameter] - own.values[parameter];
            let away = if is_turn {
                away - TAU * (away / TAU).round()
            } else {
                away
            };
            Some(weight * away * away)
        };
        // An event happens more than once, at other times.
        match own.effect.may_repeat() {
            true => 0.0,
            false => self.ranked.iter().filter_map(square).sum(),
        }
    }

    /// Probability that an effect is missing: the sum over all explanations that have it, or a law of which it
    /// is a limit.
    pub fn probability(&self, effect: EffectAt) -> f64 {
        let is = |own: &EffectAt| is_or_contains(own, &effect);
        let with = self
            .ranked
            .iter()
            .filter(|own| own.0.effects().iter().any(is));
        with.map(|own| own.1).sum::<f64>().min(1.0)
    }

    /// Log evidence of an explanation relative to the refitted model.
    pub fn log_evidence(&self, own: &Explanation) -> f64 {
        own.log_evidence(self.temperature) - self.baseline.log_evidence(self.temperature)
    }

    /// Fitted points of the explanations that are worth another look, one for each structure: those that are not
    /// decisively less probable than the reported one. What is not reported for its parameters may be determined there.
    pub fn points(&self) -> Vec<Point> {
        let log = |own: &Explanation| own.log_evidence(self.temperature);
        let least = log(&self.best) - DECISIVE;
        let worth = self.ranked.iter().filter(|own| log(&own.0) >= least);
        let points = worth.map(|own| own.0.fitted.point.clone());
        points.take(WORTH_ANOTHER_LOOK).collect()
    }
}

/// Most explanations that are reused when the same recordings are looked at in another way.
const WORTH_ANOTHER_LOOK: usize = 20;

/// Log of odds that leave no doubt, even if the priors are known only within a factor of a few: twice what Kass and
/// Raftery (1995) call very strong.
const DECISIVE: f64 = 10.0;

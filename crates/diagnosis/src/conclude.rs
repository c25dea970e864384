//! From what the search found to verdict, findings and the better model.

use super::bootstrap::{Scatter, bootstrap};
use super::criteria::Search;
use super::document::{Candidate, Diagnosis, Finding, Fit, FittedParameter, Location, Verdict};
use super::explanation::Explanation;
use super::found::{Found, Trial};
use super::locate::Located;
use super::point::{EffectAt, Global};
use super::quality::{level, quality};
use super::summary::{summary, times, whole};
use super::thresholds::EQUAL;
use super::tracker_scale::TrackerScale;
use quell_model::effects::Effect;
use quell_model::{Model, ModelEffect, Value};
use std::collections::BTreeMap;

/// Residual, in times the noise, that anyone sees in a plot of it.
const PLAIN: f64 = 2.0;

/// All of a diagnosis that follows from a search, and a scale of a tracker that is told in it; the intervals are
/// drawn with a seed.
pub fn conclude(
    search: &Search,
    found: &Found,
    located: &Located,
    remarks: Vec<String>,
    seed: u64,
) -> (Diagnosis, Option<TrackerScale>) {
    let verdict = verdict(search, found, located);
    let findings = match verdict {
        Verdict::NoMismatch | Verdict::Unexplained | Verdict::NotExcited => Vec::new(),
        _ => findings(search, found, &bootstrap(search, &found.best, seed)),
    };
    let fit = Fit {
        before: quality(search, &found.baseline),
        after: match findings.is_empty() {
            true => quality(search, &found.baseline),
            false => quality(search, &found.best),
        },
        ..level(search.problem)
    };
    let mut diagnosis = Diagnosis {
        verdict,
        summary: String::new(),
        findings,
        location: match verdict {
            Verdict::NoMismatch => Location::default(),
            _ => located.location.clone(),
        },
        fit,
        nuisances: nuisances(search, reported(verdict, found)),
        next_move: None,
        candidates: found.trials.iter().filter_map(candidate).collect(),
        remarks,
    };
    let scale = super::tracker_scale::tell(search, &mut diagnosis);
    diagnosis.summary = summary(
        &diagnosis,
        scale.as_ref(),
        search.judge.data.judged_by,
        search.problem.catalogue,
    );
    (diagnosis, scale)
}

/// The explanation that is offered: never one that was not believed.
pub fn reported(verdict: Verdict, found: &Found) -> &Explanation {
    match verdict {
        Verdict::NoMismatch | Verdict::Unexplained | Verdict::NotExcited => &found.baseline,
        _ => &found.best,
    }
}

/// Named where the best explanation leaves nothing but noise (or, one law, a hundredth of the mismatch, fitted
/// and held out: none of the catalogue has the shape of nature to better than a tenth in amplitude).
fn verdict(search: &Search, found: &Found, located: &Located) -> Verdict {
    if found.best.effects().is_empty() {
        return match search.is_quiet(&found.baseline, located) {
            true => Verdict::NoMismatch,
            false => Verdict::Unexplained,
        };
    }
    // What is left in plain sight is not explained, however much more there was.
    let seen = !search.below(&found.best, PLAIN);
    let noise = search.at_noise(&found.best) && search.is_held_noise(&found.best);
    // A second law takes up what the shape of the first one leaves: beside it nothing else may be left.
    let one = found.best.effects().len() == 1 || stands_for_one(found);
    let shape = one
        && search.explains(&found.baseline, &found.best)
        && search.predicts(&found.baseline, &found.best);
    if seen || !(noise || shape) {
        return Verdict::PartlyExplained;
    }
    match found.equals.is_empty() {
        true => Verdict::Named,
        false => Verdict::Ambiguous,
    }
}

fn candidate(trial: &Trial) -> Option<Candidate> {
    let effects = trial.explanation.effects();
    let names: Vec<&str> = effects.iter().map(|effect| effect.0.name).collect();
    let finite = trial.delta_bic.is_finite() && trial.held_out_ratio.is_finite();
    finite.then(|| Candidate {
        effect: names.join(" + "),
        place: effects
            .last()
            .map_or("", |effect| effect.1.name())
            .to_string(),
        delta_bic: trial.delta_bic,
        held_out_ratio: trial.held_out_ratio,
    })
}

/// The effects of the best explanation, the one whose absence costs most first; two that stand for one law in
/// the order of its parts, the larger first.
fn findings(search: &Search, found: &Found, scatter: &Scatter) -> Vec<Finding> {
    let best = &found.best;
    let told = |effect| {
        let gain = found.without(effect).train - best.train;
        let parameters = parameters(search, best, effect, scatter);
        (gain, finding(search, found, effect, parameters))
    };
    let mut findings: Vec<(f64, Finding)> = best.effects().into_iter().map(told).collect();
    if !stands_for_one(found) {
        findings.sort_by(|a, b| b.0.total_cmp(&a.0));
    }
    findings.into_iter().map(|(_, finding)| finding).collect()
}

/// Whether the best explanation is that of one law, told as its parts.
fn stands_for_one(found: &Found) -> bool {
    let own = found.best.effects();
    let whole = |equal: &Trial| {
        let point = &equal.explanation.fitted.point;
        let [term] = &point.terms[point.given_terms..] else {
            return false;
        };
        let parts = term.effect.parts(&term.values);
        parts.is_some_and(|parts| {
            let own = own.iter().map(|effect| effect.0);
            own.eq(parts.iter().map(|part| part.0))
        })
    };
    found.equals.iter().any(whole)
}

fn finding(
    search: &Search,
    found: &Found,
    effect: EffectAt,
    parameters: Vec<FittedParameter>,
) -> Finding {
    let (best, without) = (&found.best, found.without(effect));
    let own = best.effects();
    let mut alternatives: Vec<(&Effect, f64)> = Vec::new();
    for equal in &found.equals {
        // What is told before a simpler law is believed no less than that.
        let worse = (search.criterion(&equal.explanation) - search.criterion(best)).max(0.0);
        for (other, _) in equal.explanation.effects() {
            let shared = own.iter().any(|own| own.0 == other);
            let known = alternatives.iter().any(|known| known.0 == other);
            if !shared && !known && replaces(best, &equal.explanation, effect) {
                alternatives.push((other, worse / found.unit));
            }
        }
    }
    let weight: f64 = alternatives
        .iter()
        .map(|(_, worse)| (-worse / EQUAL).exp())
        .sum();
    let noise = |chi: f64, rows: usize| (chi / rows.max(1) as f64).sqrt();
    let rows = search.judge.held_out_rows;
    Finding {
        effect: effect.0.name.to_string(),
        place: effect.1.name().to_string(),
        probability: 1.0 / (1.0 + weight),
        parameters,
        evidence: format!(
            "Without it the residual on what was held out is {} times the noise, with it {}; the \
             Bayesian information criterion falls by {}.",
            times(noise(without.held_out, rows)),
            times(noise(best.held_out, rows)),
            whole((search.criterion(without) - search.criterion(best)) / found.unit),
        ),
        alternatives: alternatives
            .into_iter()
            .map(|(other, _)| other.name.to_string())
            .collect(),
    }
}

/// Whether an explanation has all other effects of the best one, so that it replaces this one.
fn replaces(best: &Explanation, other: &Explanation, effect: EffectAt) -> bool {
    let (own, theirs) = (best.effects(), other.effects());
    let mut kept = own.iter().filter(|kept| **kept != effect);
    kept.all(|kept| theirs.iter().any(|other| other.0 == kept.0)) || theirs.len() < own.len()
}

fn parameters(
    search: &Search,
    best: &Explanation,
    effect: EffectAt,
    scatter: &Scatter,
) -> Vec<FittedParameter> {
    let point = &best.fitted.point;
    let units = super::units::units(search.problem, point);
    let terms = (point.given_terms..point.terms.len())
        .filter(|term| point.terms[*term].identity() == effect);
    let mut all = Vec::new();
    for (count, term) in terms.enumerate() {
        let own = &point.terms[term];
        for (index, parameter) in own.effect.parameters.iter().enumerate() {
            all.push(FittedParameter {
                name: match count {
                    0 => parameter.name.to_string(),
                    _ => format!("{}_{}", parameter.name, count + 1),
                },
                value: own.values[index],
                unit: parameter.quantity.unit(&units),
                ci95: scatter.interval(search.problem, point, Global::Parameter(term, index)),
            });
        }
    }
    all
}

fn nuisances(search: &Search, explanation: &Explanation) -> BTreeMap<String, f64> {
    let mut all = BTreeMap::new();
    let point = &explanation.fitted.point;
    for (e, experiment) in search.problem.experiments.iter().enumerate() {
        let mark = if e == 0 {
            String::new()
        } else {
            format!("_{}", e + 1)
        };
        for (k, output) in experiment
            .outputs
            .iter()
            .enumerate()
            .filter(|(_, o)| o.own_clock)
        {
            let name = match k {
                0 => format!("clock_offset_s{mark}"),
                _ => format!("clock_offset_of_{}_s{mark}", output.channel.name()),
            };
            all.insert(name, point.locals[e].clocks[k]);
        }
    }
    for index in search.problem.free_payloads.clone() {
        let payload = search.problem.payloads[index].as_deref().unwrap_or("none");
        all.insert(
            format!("relative_inertia_with_payload {payload}"),
            point.inertias[index],
        );
    }
    for &key in &search.problem.free {
        all.insert(
            search.problem.kind.keys[key].name.to_string(),
            point.keys[key],
        );
    }
    all
}

/// The model with the findings in it, its parameters as they were fitted.
pub fn better_model(model: &Model, explanation: &Explanation) -> Model {
    let mut better = model.clone();
    let point = &explanation.fitted.point;
    for (value, fitted) in better.values.iter_mut().zip(&point.keys) {
        value.value = *fitted;
    }
    let (given, found) = point.terms.split_at(point.given_terms);
    for (effect, term) in better.effects.iter_mut().zip(given) {
        for (value, fitted) in effect.parameters.iter_mut().zip(&term.values) {
            value.value = *fitted;
        }
    }
    for term in found {
        better.effects.push(ModelEffect {
            effect: term.effect,
            place: term.place,
            parameters: term
                .values
                .iter()
                .map(|value| Value::from(*value))
                .collect(),
        });
    }
    better
}

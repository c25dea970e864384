//! From what the search found to verdict, findings and the better model.

use super::document::{
    Candidate, Diagnosis, Finding, Fit, FittedParameter, Location, Quality, Verdict,
};
use super::explanation::Explanation;
use super::locate::Located;
use super::problem::{Global, Problem, Rows};
use super::search::{EQUAL, Found, Search, Trial, ratio};
use crate::model::{Model, ModelEffect, Value};
use std::collections::BTreeMap;

/// Two-sided 95 % of the normal distribution, in standard deviations.
const NORMAL_95: f64 = 1.959_964;

/// Residual, in times the noise, that is a mismatch even if it cannot be located: no estimate of a noise
/// level is that far off.
const CERTAIN: f64 = 1.5;

/// All of a diagnosis that follows from a search.
pub fn conclude(
    search: &Search,
    found: &Found,
    located: &Located,
    remarks: Vec<String>,
) -> Diagnosis {
    let verdict = verdict(search, found, located);
    let findings = match verdict {
        Verdict::NoMismatch | Verdict::Unexplained => Vec::new(),
        _ => findings(search, found),
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
    diagnosis.summary = super::summary::summary(&diagnosis);
    diagnosis
}

/// The explanation that is offered: never one that was not believed.
pub fn reported(verdict: Verdict, found: &Found) -> &Explanation {
    match verdict {
        Verdict::NoMismatch | Verdict::Unexplained => &found.baseline,
        _ => &found.best,
    }
}

/// Named where the best explanation leaves nothing but noise (or a hundredth of the mismatch: no law
/// of the catalogue has the shape of nature to better than a tenth in amplitude).
fn verdict(search: &Search, found: &Found, located: &Located) -> Verdict {
    if found.best.effects().is_empty() {
        let quiet = search.at_floor(&found.baseline) && search.held_at_floor(&found.baseline);
        // A little above the floor may be noise of another colour, unless it has a place in the chain.
        let little = search.below(&found.baseline, CERTAIN) && located.location.place.is_none();
        return match quiet || little {
            true => Verdict::NoMismatch,
            false => Verdict::Unexplained,
        };
    }
    if !search.explains(&found.baseline, &found.best) {
        return Verdict::PartlyExplained;
    }
    match found.equals.is_empty() {
        true => Verdict::Named,
        false => Verdict::Ambiguous,
    }
}

fn candidate(trial: &Trial) -> Option<Candidate> {
    let effects = trial.explanation.effects();
    let names: Vec<&str> = effects.iter().map(|effect| effect.0).collect();
    trial.delta_bic.is_finite().then(|| Candidate {
        effect: names.join(" + "),
        place: effects
            .last()
            .map_or("", |effect| effect.1.name())
            .to_string(),
        delta_bic: trial.delta_bic,
        held_out_ratio: trial.held_out_ratio,
    })
}

/// The effects of the best explanation, the one whose absence costs most first.
fn findings(search: &Search, found: &Found) -> Vec<Finding> {
    let best = &found.best;
    let point = &best.fitted.point;
    let mut findings: Vec<(f64, Finding)> = (point.fixed_terms..point.terms.len())
        .map(|term| {
            let alone = found.without(term);
            let gain = alone.train - best.train;
            (gain, finding(search, found, term, alone))
        })
        .collect();
    findings.sort_by(|a, b| b.0.total_cmp(&a.0));
    findings.into_iter().map(|(_, finding)| finding).collect()
}

fn finding(search: &Search, found: &Found, term: usize, without: &Explanation) -> Finding {
    let best = &found.best;
    let point = &best.fitted.point;
    let own = &point.terms[term];
    let mut alternatives: Vec<(String, f64)> = Vec::new();
    for equal in &found.equals {
        let others = &equal.explanation.fitted.point.terms[point.fixed_terms..];
        let worse = search.criterion(&equal.explanation) - search.criterion(best);
        for other in others {
            let shared = point.terms[point.fixed_terms..]
                .iter()
                .any(|term| term.effect.name == other.effect.name);
            let known = alternatives
                .iter()
                .any(|known| known.0 == other.effect.name);
            if !shared && !known && replaces(best, &equal.explanation, term) {
                alternatives.push((other.effect.name.to_string(), worse / found.unit));
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
        effect: own.effect.name.to_string(),
        place: own.place.name().to_string(),
        probability: 1.0 / (1.0 + weight),
        parameters: parameters(search, found, term),
        evidence: format!(
            "Without it the residual on what was held out is {:.2} times the noise, with it {:.2}; the \
             Bayesian information criterion falls by {:.0}.",
            noise(without.held_out, rows),
            noise(best.held_out, rows),
            (search.criterion(without) - search.criterion(best)) / found.unit,
        ),
        alternatives: alternatives.into_iter().map(|(name, _)| name).collect(),
    }
}

/// Whether an explanation has all other effects of the best one, so that it replaces this one.
fn replaces(best: &Explanation, other: &Explanation, term: usize) -> bool {
    let terms = &best.fitted.point.terms;
    let (first, theirs) = (best.fitted.point.fixed_terms, other.effects());
    let kept = (first..terms.len())
        .filter(|&k| k != term)
        .all(|k| theirs.iter().any(|effect| effect.0 == terms[k].effect.name));
    kept || theirs.len() < terms.len() - first
}

fn parameters(search: &Search, found: &Found, term: usize) -> Vec<FittedParameter> {
    let best = &found.best;
    let own = &best.fitted.point.terms[term];
    let experiment = &search.problem.experiments[0];
    let (force, position) = super::units::units(search.problem.kind, experiment);
    let fitted = |(index, parameter): (usize, &crate::effects::Parameter)| {
        let global = Global::Parameter(term, index);
        let value = own.values[index];
        let (low, high) = search.problem.limits(&best.fitted.point, global);
        let reach = NORMAL_95 * deviation(best, global, found.unit);
        FittedParameter {
            name: parameter.name.to_string(),
            value,
            unit: parameter.quantity.unit(&force, &position),
            ci95: [
                (value - reach).max(low.min(value)),
                (value + reach).min(high.max(value)),
            ],
        }
    };
    own.effect
        .parameters
        .iter()
        .enumerate()
        .map(fitted)
        .collect()
}

/// Standard deviation of a shared unknown, in its own unit, what the model leaves taken as noise.
fn deviation(best: &Explanation, global: Global, unit: f64) -> f64 {
    let index = best.fitted.globals.iter().position(|g| *g == global);
    index.map_or(f64::INFINITY, |i| {
        (best.fitted.covariance[(i, i)].max(0.0) * unit).sqrt()
    })
}

/// Root mean square residuals in the unit of the first output.
fn quality(search: &Search, explanation: &Explanation) -> Quality {
    let judge = search.judge;
    let problem = search.problem;
    let point = &explanation.fitted.point;
    let noise = level(problem).noise_std;
    let [train, train_over] = rms(search, point, &problem.rows);
    let [held, held_over] = match judge.data.apart.is_empty() {
        true => rms(search, point, &judge.data.held_out),
        false => {
            let over = ratio(explanation.held_out, judge.held_out_rows as f64).sqrt();
            [noise * over, over]
        }
    };
    let there = held.is_finite();
    Quality {
        train_rms: train,
        held_out_rms: if there { held } else { train },
        held_out_over_noise: if there { held_over } else { train_over },
    }
}

/// Root mean square residual of the first outputs: in their unit, and in times the noise of each recording.
fn rms(search: &Search, point: &super::problem::Point, rows: &[Vec<Rows>]) -> [f64; 2] {
    let (mut sum, mut over, mut count) = (0.0, 0.0, 0);
    for (e, rows) in rows.iter().enumerate() {
        let residual = search
            .judge
            .explained(search.problem, search.projector, point, e);
        let scale = search.problem.experiments[e].outputs[0].scale;
        let noise = search.problem.whitening[e][0].deviation;
        for range in &rows[0] {
            let own = residual[0][range.clone()].iter();
            let square: f64 = own.map(|r| r * r).sum();
            sum += square * scale * scale;
            over += square / (noise * noise);
            count += range.len();
        }
    }
    [sum, over].map(|sum| (sum / count as f64).sqrt())
}

/// Noise of the first output.
fn level(problem: &Problem) -> Fit {
    let output = &problem.experiments[0].outputs[0];
    let nothing = Quality {
        train_rms: 0.0,
        held_out_rms: 0.0,
        held_out_over_noise: 0.0,
    };
    Fit {
        noise_std: problem.whitening[0][0].deviation * output.scale,
        unit: output.unit.clone(),
        before: nothing,
        after: nothing,
    }
}

/// Clock offsets and the model's own parameters, with their standard deviations.
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
    for (effect, term) in better.effects.iter_mut().zip(&point.terms) {
        for (value, fitted) in effect.parameters.iter_mut().zip(&term.values) {
            value.value = *fitted;
        }
    }
    for term in &point.terms[point.fixed_terms..] {
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

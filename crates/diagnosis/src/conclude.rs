//! Verdict, findings and the better model from the result of the search.

use super::alternatives::alternatives;
use super::better_model::better_model;
use super::bootstrap::{Scatter, bootstrap};
use super::document::{
    Candidate, Diagnosis, Finding, Fit, FittedParameter, Location, Quality, Scored, Verdict,
};
use super::draw::shown;
use super::explanation::Explanation;
use super::final_fit::with_final_fit;
use super::found::Found;
use super::law_band::law_curve;
use super::locate::Located;
use super::nuisances::{intervals_of_keys, nuisances};
use super::outcome::Options;
use super::point::{EffectAt, Global, Point};
use super::quality::{level, quality};
use super::scores::{Laden, Recordings, scores, take_over};
use super::search::Search;
use super::split::HeldOut;
use super::summary::{odds, summary, times};
use super::tracker_scale::TrackerScale;
use super::units::told_in;
use quell_model::Model;

/// Remark on intervals without a bootstrap.
const UNDRAWN: &str =
    "The time was over before the bootstrap: the intervals are those of the linearised fit.";

/// A diagnosis, and what follows from it alone.
pub struct Concluded {
    /// What is said.
    pub diagnosis: Diagnosis,
    /// The finding on a tracker's scale, if there is one.
    pub scale: Option<TrackerScale>,
    /// The model with the findings in it.
    pub better: Model,
    /// What is told, in its final fit.
    pub point: Point,
}

/// All conclusions from a search.
pub fn conclude(
    search: &Search,
    found: &Found,
    located: &Located,
    told: (Recordings, Vec<String>),
    options: &Options,
) -> Concluded {
    with_final_fit(search, found, &options.enough, |whole, last| {
        concluded((search, found), (whole, last), located, told, options)
    })
}

/// The same with the search over the rows of the final fit, and with the refitted model and the best explanation there.
fn concluded(
    (search, found): (&Search, &Found),
    (whole, last): (&Search, [&Explanation; 2]),
    located: &Located,
    (recordings, mut remarks): (Recordings, Vec<String>),
    options: &Options,
) -> Concluded {
    let verdict = verdict(search, found, located);
    let [last_baseline, last_best] = last;
    let scatter = bootstrap(whole, last_best, found, options);
    if !scatter.is_drawn {
        remarks.push(UNDRAWN.into());
    }
    let told = reported(verdict, last);
    let machine = whole.machine(&told.fitted.point);
    let fit = fit(
        search,
        found,
        reported(verdict, [&found.baseline, &found.best]),
    );
    let findings = match verdict {
        Verdict::NoMismatch | Verdict::Unexplained | Verdict::NotExcited => Vec::new(),
        _ => findings((search, found), (whole, last_best), &scatter, &fit.after),
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
        nuisances: nuisances(whole, told),
        nuisances_ci95: intervals_of_keys(whole, last_best, &scatter),
        next_move: None,
        candidates: found
            .ranked
            .iter()
            .filter_map(|own| candidate(search, found, own))
            .collect(),
        ended_early: false,
        remarks,
    };
    let scale = super::tracker_scale::tell(search, &mut diagnosis);
    let given = search.judge.model;
    let points = [&last_baseline.fitted.point, &machine];
    let [refitted, better] = points.map(|point| better_model(given, point));
    let better = match &scale {
        Some(scale) => scale.corrected(better),
        None => better,
    };
    let models = [&refitted, &better];
    let [before, after] = [0, 1].map(|k| Laden {
        model: models[k],
        payloads: &search.problem.payloads,
        inertias: &points[k].inertias,
    });
    let with_findings = (!diagnosis.findings.is_empty()).then_some(after);
    diagnosis.fit.scores = scores(before, with_findings, recordings);
    if is_seen_alike(search, &diagnosis.fit) {
        take_over(&mut diagnosis.fit);
    }
    let (first, output) = (
        &search.problem.experiments[0],
        &search.problem.experiments[0].outputs[0],
    );
    let motion = shown(first, output)
        .iter()
        .fold(0.0, |most: f64, y| most.max(y.abs()));
    diagnosis.summary = summary(
        (search, found, whole.leaves_noise(last_best)),
        &diagnosis,
        diagnosis.fit.shown(motion * output.scale),
        scale.as_ref(),
    );
    if found.is_unfinished {
        diagnosis.end_early();
    }
    Concluded {
        diagnosis,
        scale,
        better,
        point: told.fitted.point.clone(),
    }
}

/// Whether the scores replay the motion as the search saw it. That holds if whole recordings are held out, both
/// replay it in one piece or both in windows, no motor side is coupled, nothing happened in one recording only,
/// and the payload is the model's.
fn is_seen_alike(search: &Search, fit: &Fit) -> bool {
    let (data, problem) = (search.judge.data, search.problem);
    let experiments = || data.experiments.iter().chain(&data.apart);
    let is_whole = |own: &Scored| own.before.windows == 1 && own.after.windows == 1;
    let in_one_piece = experiments().all(|own| own.windows.is_empty());
    data.judged_by == HeldOut::Recordings
        && experiments().all(|own| own.coupling.is_none())
        && fit.model_alone.is_none()
        && fit.scores.len() == experiments().count()
        && fit.scores.iter().all(|own| is_whole(own) == in_one_piece)
        && experiments().all(|own| own.payload == problem.payloads[0])
}

fn fit(search: &Search, found: &Found, told: &Explanation) -> Fit {
    let of = |point: &Point| quality(search, point);
    let told = &told.fitted.point;
    let machine = search.machine(told);
    Fit {
        before: of(&found.baseline.fitted.point),
        after: of(told),
        model_alone: (machine.terms.len() < told.terms.len()).then(|| of(&machine)),
        ..level(search.problem)
    }
}

/// The one that is reported of the refitted model and the best explanation: the former unless the verdict supports the latter.
pub fn reported(verdict: Verdict, [baseline, best]: [&Explanation; 2]) -> &Explanation {
    match verdict {
        Verdict::NoMismatch | Verdict::Unexplained | Verdict::NotExcited => baseline,
        _ => best,
    }
}

/// The verdict. `NoMismatch`: no effect is found and only noise is left. `Named`: with the effects only noise
/// is left, or no more than an error of their laws' shapes explains, and the credible set holds no other
/// explanation.
fn verdict(search: &Search, found: &Found, located: &Located) -> Verdict {
    if found.best.terms() == 0 {
        return match search.leaves_nothing(found, located) {
            true => Verdict::NoMismatch,
            false => Verdict::Unexplained,
        };
    }
    if !search.explains(found) {
        return Verdict::PartlyExplained;
    }
    match found.equals.is_empty() {
        true => Verdict::Named,
        false => Verdict::Ambiguous,
    }
}

fn candidate(
    search: &Search,
    found: &Found,
    (own, probability): &(Explanation, f64),
) -> Option<Candidate> {
    let effects = own.effects();
    let names: Vec<&str> = effects.iter().map(|effect| effect.0.name).collect();
    let log_evidence = found.log_evidence(own);
    let refused = search.refusal(&found.refused, found.temperature, own);
    let held_out_ratio = match found.baseline.held_out > 0.0 {
        true => own.held_out / found.baseline.held_out,
        false => 1.0,
    };
    let finite = log_evidence.is_finite() && held_out_ratio.is_finite();
    let (_, place) = effects.last()?;
    finite.then(|| Candidate {
        effect: names.join(" + "),
        place: place.name().to_string(),
        log_evidence,
        probability: *probability,
        held_out_ratio,
        refused,
    })
}

/// The effects of the best explanation, which leaves `left`, in falling order of the evidence that is lost without them.
fn findings(
    (search, found): (&Search, &Found),
    (whole, last): (&Search, &Explanation),
    scatter: &Scatter,
    left: &Quality,
) -> Vec<Finding> {
    let best = &found.best;
    let told = |effect| {
        let gain = found.without(effect).train - best.train;
        let parameters = parameters(whole, last, effect, scatter);
        let mut finding = finding(search, found, effect, parameters, left);
        finding.curve = law_curve(whole.problem, &last.fitted.point, effect, scatter);
        (gain, finding)
    };
    let mut findings: Vec<(f64, Finding)> = best.effects().into_iter().map(told).collect();
    findings.sort_by(|a, b| b.0.total_cmp(&a.0));
    findings.into_iter().map(|(_, finding)| finding).collect()
}

fn finding(
    search: &Search,
    found: &Found,
    effect: EffectAt,
    parameters: Vec<FittedParameter>,
    left: &Quality,
) -> Finding {
    let (best, without) = (&found.best, found.without(effect));
    let equals: Vec<_> = found.equals.iter().map(Explanation::effects).collect();
    let left_without = quality(search, &without.fitted.point);
    let log_odds = found.log_evidence(best) - found.log_evidence(without);
    let weighed = match search.refusal(&found.refused, found.temperature, without) {
        // It is told for the sake of the others: without it they say something that cannot be.
        Some(why) if log_odds < 0.0 => format!("The explanation without it is refused: {why}."),
        _ => format!("The odds for it are {}.", odds(log_odds)),
    };
    Finding {
        effect: effect.0.name.to_string(),
        place: effect.1.name().to_string(),
        probability: found.probability(effect),
        parameters,
        evidence: format!(
            "Without it the residual of the held-out data is {} times as large. {weighed}",
            times(left_without.held_out_over_noise / left.held_out_over_noise),
        ),
        alternatives: alternatives(effect, &best.effects(), &equals)
            .into_iter()
            .map(|other| other.name.to_string())
            .collect(),
        happened_in: Vec::new(),
        curve: None,
    }
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
            if own.effect.is_without(index, own.values[index]) {
                continue;
            }
            let (factor, unit) = told_in(parameter, &units);
            let ci95 = scatter.interval(search.problem, point, Global::Parameter(term, index));
            all.push(FittedParameter {
                name: match count {
                    0 => parameter.name.to_string(),
                    _ => format!("{}_{}", parameter.name, count + 1),
                },
                value: own.values[index] * factor,
                unit,
                ci95: ci95.map(|edge| edge * factor),
            });
        }
    }
    all
}

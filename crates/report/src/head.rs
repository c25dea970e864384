//! The top of the page: the verdict and the key figures.

use super::case::Case;
use super::{law, words};
use quell_diagnosis::{Finding, Fit, Quality, Verdict};
use quell_page::{self as html, Figure, Page, digits, fixed, number};

/// Title, verdict in one sentence, key figures.
pub fn head(case: &Case, model_name: &str, recording_names: &[String]) -> Page {
    let diagnosis = case.diagnosis;
    let names = words::list(recording_names, "and");
    let sign = match diagnosis.verdict {
        Verdict::NoMismatch => html::Verdict::Good,
        Verdict::Named | Verdict::Ambiguous => html::Verdict::Plain,
        Verdict::PartlyExplained | Verdict::Unexplained | Verdict::NotExcited => html::Verdict::Bad,
    };
    let title = match recording_names {
        [] => "Diagnosis".into(),
        [one] => format!("Diagnosis of {one}"),
        [first, rest @ ..] => format!("Diagnosis of {first} and {} more", rest.len()),
    };
    Page::new(title)
        .subtitle(format!("{names}, held against the model {model_name}"))
        .verdict(sign, diagnosis.summary.clone())
        .figures(figures(case))
}

fn figures(case: &Case) -> Vec<Figure> {
    let diagnosis = case.diagnosis;
    let first = diagnosis.findings.first();
    if diagnosis.verdict == Verdict::NotExcited {
        return Vec::new();
    }
    let mut figures = vec![misfit(case), over_noise(case)];
    match diagnosis.verdict {
        Verdict::NoMismatch => figures.push(catalogue(case, "none is needed")),
        Verdict::Unexplained => {
            figures.push(catalogue(case, "none explains it"));
            figures.extend(diagnosis.location.frequency_hz.map(frequency));
        }
        _ => {}
    }
    let sizes = diagnosis.findings.iter().take(2);
    figures.extend(sizes.filter_map(|finding| size(case, finding)));
    match first {
        Some(_) if diagnosis.findings.len() > 1 => {}
        Some(finding) if finding.alternatives.is_empty() => {
            figures.push(probability(case, finding))
        }
        Some(finding) => figures.push(set_size(case, finding)),
        None => {}
    }
    figures
}

/// `before → after`, or `before` alone where there is no other model.
fn arrow(before: String, after: String, has_after: bool) -> String {
    match has_after {
        true => format!("{before} \u{2192} {after}"),
        false => before,
    }
}

/// The held-out residual if known, else that of the fitted data.
fn rms_of(quality: &Quality) -> f64 {
    match quality.held_out_rms.is_finite() {
        true => quality.held_out_rms,
        false => quality.train_rms,
    }
}

/// The held-out residual over the noise.
pub fn ratio_of(quality: &Quality, fit: &Fit) -> f64 {
    match quality.held_out_over_noise.is_finite() {
        true => quality.held_out_over_noise,
        false => quality.train_rms / fit.noise_std,
    }
}

fn over_noise(case: &Case) -> Figure {
    let fit = &case.diagnosis.fit;
    let [before, after] = [&fit.before, &fit.after].map(|quality| times(ratio_of(quality, fit)));
    let value = arrow(before, after, case.has_after());
    Figure::text("misfit, times the noise", value).note("1 is noise alone; on the held-out data")
}

/// A ratio with two decimals, one from ten on, none from a hundred on.
pub fn times(ratio: f64) -> String {
    match ratio {
        ratio if ratio < 10.0 => fixed(ratio, 2),
        ratio if ratio < 100.0 => fixed(ratio, 1),
        ratio => number(digits(ratio, 3)),
    }
}

fn misfit(case: &Case) -> Figure {
    let fit = &case.diagnosis.fit;
    let shown = case.misfit_unit();
    let [before, after] = [&fit.before, &fit.after].map(|quality| shown.number(rms_of(quality)));
    let noise = shown.number(fit.noise_std);
    Figure::text("misfit, rms", arrow(before, after, case.has_after()))
        .unit(shown.unit.clone())
        .note(format!("the noise is {noise} {}", shown.unit))
}

fn catalogue(case: &Case, note: &str) -> Figure {
    let count = case.catalogue.0.len();
    Figure::text("effects in the catalogue", count.to_string()).note(note)
}

fn frequency(frequency: f64) -> Figure {
    Figure::text("stands out at", number(digits(frequency, 3)))
        .unit("Hz")
        .note("in the misfit's spectrum")
}

/// The held-out residual: in the unit of the recording, then relative to the noise.
pub fn left(case: &Case) -> String {
    left_by(case, &case.diagnosis.fit.after)
}

/// The same of another model.
pub fn left_by(case: &Case, quality: &Quality) -> String {
    let shown = case.misfit_unit();
    format!(
        "{} {} rms, {} times the noise",
        shown.number(rms_of(quality)),
        shown.unit,
        times(ratio_of(quality, &case.diagnosis.fit))
    )
}

/// The size of a finding, with its interval; for a learned law its largest value.
fn size(case: &Case, finding: &Finding) -> Option<Figure> {
    if finding.learned().is_some() {
        return largest(case, finding);
    }
    let parameter = case.size(finding)?;
    let shown = case.shown(&finding.effect, parameter);
    let name = match parameter.name.as_str() {
        name if finding.effect.contains(name) => case.told(finding),
        name => format!("{}: {}", case.told(finding), case.parameter(finding, name)),
    };
    let figure = Figure::text(name, shown.quoted(parameter.value, parameter.ci95));
    let interval = format!("95 %: {}", shown.interval(parameter.ci95));
    Some(figure.unit(shown.unit.clone()).note(interval))
}

/// The value of a law's curve that is farthest from 0.
fn largest(case: &Case, finding: &Finding) -> Option<Figure> {
    let curve = finding.curve.as_ref()?;
    let all = curve.values.iter().zip(&curve.ci95);
    let (value, band) = all.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))?;
    let shown = law::law_unit(curve);
    let name = format!("{}: largest {}", case.told(finding), curve.law);
    let interval = format!("95 %: {}", shown.interval(*band));
    let figure = Figure::text(name, shown.quoted(*value, *band));
    Some(figure.unit(shown.unit).note(interval))
}

fn set_size(case: &Case, finding: &Finding) -> Figure {
    let count = 1 + finding.alternatives.len();
    Figure::text("explanations that fit alike", count.to_string())
        .note(words::list(&case.set(finding), "or"))
}

fn probability(case: &Case, finding: &Finding) -> Figure {
    let note = format!("for {}, among what was tried", case.title(&finding.effect));
    Figure::text("probability", words::percent(finding.probability))
        .unit("%")
        .note(note)
}

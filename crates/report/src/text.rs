//! The text of a diagnosis for people.

use std::path::PathBuf;

use super::case::Case;
use super::score::{NOISE_ANEW, score_beside};
use super::{happened, head, law, next, words};
use quell_diagnosis::{Finding, Fit, NextMove, Verdict};
use quell_page::{columns, number};

/// The verdict, the findings, the fit, what to do next, and the files that were written.
pub fn text(case: &Case, files: &[PathBuf]) -> String {
    let diagnosis = case.diagnosis;
    let mut parts = vec![format!("{}\n", diagnosis.summary)];
    parts.push(parameters(case));
    parts.push(explanations(case));
    if diagnosis.verdict != Verdict::NotExcited {
        parts.push(fit(case));
    }
    let mut lines: Vec<String> = diagnosis
        .findings
        .iter()
        .flat_map(|finding| what_to_know(case, finding))
        .collect();
    if diagnosis.verdict == Verdict::Unexplained {
        lines.extend(
            diagnosis
                .location
                .place
                .as_deref()
                .and_then(words::look)
                .map(String::from),
        );
    }
    lines.extend(diagnosis.next_move.iter().flat_map(next_move));
    lines.extend(diagnosis.remarks.iter().map(|remark| format!("- {remark}")));
    parts.push(lines.iter().map(|line| format!("{line}\n")).collect());
    let files: Vec<_> = files
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    if !files.is_empty() {
        parts.push(format!("Written: {}\n", files.join(", ")));
    }
    parts.retain(|part| !part.is_empty());
    parts.join("\n")
}

/// A line for each parameter; nothing where there is none.
fn parameters(case: &Case) -> String {
    let findings = &case.diagnosis.findings;
    let all = findings
        .iter()
        .flat_map(|finding| words::numbers(finding).iter().map(move |p| (finding, p)));
    let rows: Vec<_> = all
        .map(|(finding, parameter)| {
            let shown = case.shown(&finding.effect, parameter);
            [
                case.told(finding),
                finding.place.clone(),
                case.parameter(finding, &parameter.name),
                shown.quoted(parameter.value, parameter.ci95),
                shown.interval(parameter.ci95),
                shown.unit,
            ]
        })
        .collect();
    let told = case.forces_told();
    let told = told.map_or_else(String::new, |told| format!("{told}\n"));
    match rows.is_empty() {
        true => String::new(),
        false => {
            columns(
                [
                    "missing",
                    "place",
                    "parameter",
                    "value",
                    "95 % interval",
                    "unit",
                ],
                rows,
            ) + &told
        }
    }
}

/// What the uncertain findings may be, a table each.
fn explanations(case: &Case) -> String {
    let findings = case.diagnosis.findings.iter();
    let tables = findings.map(|finding| possible(case, finding));
    let tables: Vec<_> = tables.filter(|table| !table.is_empty()).collect();
    tables.join("\n")
}

/// What an uncertain finding may be, with the probabilities; nothing for a certain one.
fn possible(case: &Case, finding: &Finding) -> String {
    if finding.is_certain() {
        return String::new();
    }
    let all = case.diagnosis.in_place(finding, case.catalogue);
    let named = all.effects.into_iter();
    let named = named.map(|(name, probability)| (case.title(name), probability));
    let nothing = case.may_be_absent(finding).then_some(all.nothing);
    let rows = named.chain(nothing.map(|probability| ("nothing".into(), probability)));
    let rows = rows.map(|(name, probability)| [name, format!("{} %", words::percent(probability))]);
    columns(["what it may be", "probability"], rows)
}

fn fit(case: &Case) -> String {
    let Fit {
        before,
        after,
        noise_std,
        ..
    } = &case.diagnosis.fit;
    let shown = case.misfit_unit();
    let over = |quality| head::times(head::ratio_of(quality, &case.diagnosis.fit));
    let rows = [
        (
            format!("held out, {} rms", shown.unit),
            shown.number(before.held_out_rms),
            shown.number(after.held_out_rms),
        ),
        (
            "held out, over the noise".to_string(),
            over(before),
            over(after),
        ),
        (
            format!("fitted, {} rms", shown.unit),
            shown.number(before.train_rms),
            shown.number(after.train_rms),
        ),
    ];
    let table = match case.has_after() {
        true => columns(
            ["misfit", "before", "after"],
            rows.map(|(name, before, after)| [name, before, after]),
        ),
        false => columns(["misfit", ""], rows.map(|(name, before, _)| [name, before])),
    };
    let mut left = match case.has_after() {
        true => format!("left: {} on what was held out\n", head::left(case)),
        false => String::new(),
    };
    left.extend(happened::left_alone(case).map(|alone| format!("{alone}\n")));
    format!(
        "{table}noise: {} {}\n{left}{}",
        shown.number(*noise_std),
        shown.unit,
        scores(case)
    )
}

/// The line of `quell score` for each recording as a whole.
fn scores(case: &Case) -> String {
    let line = |name: &str, which: &str, score| {
        let told = score_beside(score, case);
        format!("quell score of {name}, {which}: {told}\n")
    };
    let all = case.diagnosis.fit.scores.iter().map(|own| {
        let before = line(&own.recording, "the model refitted", &own.before);
        match case.has_after() {
            true => before + &line(&own.recording, "with the findings", &own.after),
            false => before,
        }
    });
    let all: String = all.collect();
    match case.noise_differs() {
        true => format!("{all}{NOISE_ANEW}\n"),
        false => all,
    }
}

/// The shape of a learned law, the remedy of a finding, and its alternatives.
fn what_to_know(case: &Case, finding: &Finding) -> Vec<String> {
    let name = words::capital(&case.title(&finding.effect));
    let others: Vec<_> = finding
        .alternatives
        .iter()
        .map(|other| case.title(other))
        .collect();
    let doubt = (!others.is_empty())
        .then(|| format!("{name} cannot be told from {}.", words::list(&others, "or")));
    let remedy = case
        .remedy(&finding.effect)
        .filter(|_| others.is_empty())
        .map(|remedy| format!("{name}: {remedy}"));
    let shape = law::lines(case, finding);
    let shape = (!shape.is_empty()).then(|| shape.join(" "));
    let happened = happened::of(finding).map(|happened| format!("{name}: {happened}"));
    let lines = shape.into_iter().chain(happened);
    lines.chain(remedy).chain(doubt).collect()
}

fn next_move(next: &NextMove) -> Vec<String> {
    let line = |one| {
        let [distance, speed, acceleration, jerk, pause] = next::shown(one).map(number);
        let unit = next::shown_unit(one);
        format!(
            "  move {distance} {unit} at {speed} {unit}/s, {acceleration} {unit}/s^2 and {jerk} {unit}/s^3, \
             wait {pause} s"
        )
    };
    let first = format!("Next: {}", next.why);
    std::iter::once(first)
        .chain(next.moves.iter().map(line))
        .collect()
}

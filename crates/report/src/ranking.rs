//! The ranking of the considered explanations.

use super::case::Case;
use super::{head, words};
use quell_diagnosis::{Candidate, Finding, Verdict};
use quell_page::{Bars, Cell, Page, Table, digits, fixed, number};
use std::collections::BTreeSet;

/// Most candidates that are drawn, and that are listed.
const DRAWN: usize = 10;
const LISTED: usize = 20;
/// Percent of the misfit at which a bar is cut off.
const CUT: f64 = 130.0;

/// The ranking, as bars and as a table.
pub fn section(page: Page, case: &Case) -> Page {
    let candidates = &case.diagnosis.candidates;
    if candidates.is_empty() {
        return page;
    }
    let heading = match case.diagnosis.verdict {
        Verdict::Unexplained => "What was tried",
        _ => "What else was considered",
    };
    page.heading(heading)
        .text(introduction(case))
        .bars(bars(case))
        .table(table(case))
}

fn introduction(case: &Case) -> String {
    let diagnosis = case.diagnosis;
    let how = "Each explanation was fitted together with the model's own parameters. Its weight is the probability that it \
               gives to the whole recording, the held-out part included.";
    let doubts: Vec<_> = diagnosis
        .findings
        .iter()
        .filter_map(|own| doubt(case, own))
        .collect();
    let none = format!(" None comes as close as {}.", case.findings());
    match (diagnosis.verdict, doubts.is_empty()) {
        (Verdict::Unexplained, _) => how.into(),
        (_, true) => format!("{how}{none}"),
        (_, false) => format!("{how}{}", doubts.concat()),
    }
}

/// Sentence on the doubt of a finding; `None` where it is certain.
fn doubt(case: &Case, finding: &Finding) -> Option<String> {
    let name = case.title(&finding.effect);
    let others: Vec<_> = finding
        .alternatives
        .iter()
        .map(|other| case.title(other))
        .collect();
    match (others.is_empty(), case.may_be_absent(finding)) {
        (false, false) => Some(format!(
            " The data cannot tell {name} from {}.",
            words::list(&others, "or")
        )),
        (false, true) => Some(format!(
            " The data cannot tell {name} from {}, or from nothing.",
            words::list(&others, "or")
        )),
        (true, true) => Some(format!(" The data do not decide whether {name} is there.")),
        (true, false) => None,
    }
}

/// The candidates, those that read alike once, by the best fit: a lesser one of the same effects at the same place is no other
/// explanation. `diagnosis.json` has all.
fn distinct<'a>(case: &Case<'a>) -> Vec<&'a Candidate> {
    let mut known = BTreeSet::new();
    let candidates = case.diagnosis.candidates.iter();
    candidates
        .filter(|one| known.insert((one.effect.as_str(), one.place.as_str())))
        .collect()
}

fn bars(case: &Case) -> Bars {
    let drawn: Vec<_> = distinct(case).into_iter().take(DRAWN).collect();
    let names = drawn
        .iter()
        .map(|one| words::capital(&case.title(&one.effect)));
    let percent = drawn
        .iter()
        .map(|one| digits(100.0 * one.held_out_ratio, 3));
    let percent: Vec<_> = percent.collect();
    let fit = &case.diagnosis.fit;
    let floor = digits(100.0 / head::ratio_of(&fit.before, fit).powi(2), 2);
    let title = "What each explanation leaves of the misfit on the held-out data";
    let bars = Bars::new(title, "%", names)
        .series("left", &percent)
        .up_to(CUT)
        .note(
            "Chi-squared, relative to the model without the effect; the shorter, the better. The order is that of the \
             log evidence.",
        );
    let marked = (0..drawn.len()).find(|&k| words::in_set(case, &drawn[k].effect));
    let bars = marked.into_iter().fold(bars, Bars::marked);
    match floor.is_finite() {
        true => bars.level(floor, "noise alone, about"),
        false => bars,
    }
}

fn table(case: &Case) -> Table {
    let candidates = distinct(case);
    let logs = candidates.iter().map(|one| one.log_evidence);
    let best = logs.fold(f64::NEG_INFINITY, f64::max);
    let mut table = Table::new("The ranking")
        .text_column("explanation")
        .column("probability", "%")
        .column("held-out ratio", "")
        .column("log evidence, less the best", "")
        .text_column("place");
    let (mut named, mut doubted) = (false, false);
    for one in candidates.iter().copied().take(LISTED) {
        table = table.row(row(case, one, best));
        // The best one is named. The others of the set may be right, and are told so, but not as firmly.
        match (words::in_set(case, &one.effect), named) {
            (false, _) => {}
            (true, false) => (table, named) = (table.marked(), true),
            (true, true) => (table, doubted) = (table.perhaps(), true),
        }
    }
    let rest = candidates.len().saturating_sub(LISTED);
    let more = match rest {
        0 => String::new(),
        rest => format!(" {rest} more are in diagnosis.json."),
    };
    let lines = match doubted {
        true => "A line at the left: the data do not exclude it. ",
        false => "",
    };
    table.note(format!(
        "{lines}Log evidence: the natural logarithm of the marginal likelihood. A difference of 3 is odds of 20 to 1, of 5 of \
         150 to 1. Probability: among the explanations that were looked at. Held-out ratio: chi-squared on the held-out \
         data, over that of the refitted model.{more}"
    ))
}

fn row(case: &Case, one: &Candidate, best: f64) -> [Cell; 5] {
    let less = fixed(one.log_evidence - best, 1).replace('-', "\u{2212}");
    [
        words::capital(&case.title(&one.effect)).into(),
        words::percent(one.probability).into(),
        digits(one.held_out_ratio, 3).into(),
        less.into(),
        one.place.clone().into(),
    ]
}

/// For a model that lacks nothing: the extent of the search.
pub fn nothing(page: Page, case: &Case) -> Page {
    let count = case.catalogue.0.len();
    let closest = match case.diagnosis.candidates.first() {
        None => "None of them was worth a fit.".into(),
        Some(best) => format!(
            "What came closest, {}, was fitted; it leaves {} % of the misfit on the held-out \
             data, and what is left is noise.",
            case.title(&best.effect),
            number(digits(100.0 * best.held_out_ratio, 3)),
        ),
    };
    page.heading("What was looked for").text(format!(
        "The {count} effects of the catalogue were held against the misfit, as far as they apply to \
             this model. {closest}"
    ))
}

//! The ranking of the explanations that were considered.

use super::case::Case;
use super::shown::digits;
use super::{head, words};
use quell_diagnosis::Verdict;
use quell_page::{Bars, Page, Table, number};

/// Candidates that are drawn, and that are listed, at most.
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
    let how = "Each explanation was fitted together with the model's own parameters and judged by \
               moves that it had not seen.";
    let doubts = diagnosis
        .findings
        .iter()
        .filter(|finding| !finding.alternatives.is_empty());
    let doubts: Vec<_> = doubts
        .map(|finding| {
            let others = finding.alternatives.iter().map(|name| case.title(name));
            let others: Vec<_> = others.collect();
            let name = case.title(&finding.effect);
            format!(
                " The data cannot tell {name} from {}.",
                words::list(&others, "or")
            )
        })
        .collect();
    let none = format!(" None comes as close as {}.", case.findings());
    match (diagnosis.verdict, doubts.is_empty()) {
        (Verdict::Unexplained, _) => how.into(),
        (_, true) => format!("{how}{none}"),
        (_, false) => format!("{how}{}", doubts.concat()),
    }
}

fn bars(case: &Case) -> Bars {
    let drawn = &case.diagnosis.candidates[..case.diagnosis.candidates.len().min(DRAWN)];
    let names = drawn
        .iter()
        .map(|one| words::capital(&case.title(&one.effect)));
    let percent = drawn
        .iter()
        .map(|one| digits(100.0 * one.held_out_ratio, 3));
    let percent: Vec<_> = percent.collect();
    let fit = &case.diagnosis.fit;
    let floor = digits(100.0 / head::ratio_of(&fit.before, fit).powi(2), 2);
    let title = "What each explanation leaves of the misfit, on moves that it was not fitted to";
    let bars = Bars::new(title, "%", names)
        .series("left", &percent)
        .up_to(CUT)
        .note("Chi-squared, relative to the model without the effect; the shorter, the better.");
    let marked = (0..drawn.len()).filter(|&k| words::in_set(case.diagnosis, &drawn[k].effect));
    let bars = marked.fold(bars, Bars::marked);
    match floor.is_finite() {
        true => bars.level(floor, "noise alone, about"),
        false => bars,
    }
}

fn table(case: &Case) -> Table {
    let candidates = &case.diagnosis.candidates;
    let mut table = Table::new("The ranking")
        .text_column("explanation")
        .text_column("place")
        .column("log evidence", "")
        .column("held-out ratio", "");
    for one in candidates.iter().take(LISTED) {
        let name = words::capital(&case.title(&one.effect));
        let numbers = [one.log_evidence, one.held_out_ratio];
        let [bic, ratio] = numbers.map(quell_page::Cell::from);
        table = table.row([name.into(), one.place.clone().into(), bic, ratio]);
        if words::in_set(case.diagnosis, &one.effect) {
            table = table.marked();
        }
    }
    let rest = candidates.len().saturating_sub(LISTED);
    let more = match rest {
        0 => String::new(),
        rest => format!(" {rest} more are in diagnosis.json."),
    };
    table.note(format!(
        "Log evidence: of the marginal likelihood, over that of the model without the effect; above 5 is strong. Held-out \
         ratio: chi-squared on moves not fitted to, over that without the effect.{more}"
    ))
}

/// For a model that lacks nothing: how much was looked for.
pub fn nothing(page: Page, case: &Case) -> Page {
    let count = case.catalogue.0.len();
    let closest = match case.diagnosis.candidates.first() {
        None => "None of them was worth a fit.".into(),
        Some(best) => format!(
            "What came closest, {}, was fitted; it leaves {} % of the misfit on moves that it was not \
             fitted to, and what is left is noise.",
            case.title(&best.effect),
            number(digits(100.0 * best.held_out_ratio, 3)),
        ),
    };
    page.heading("What was looked for").text(format!(
        "The {count} effects of the catalogue were held against the misfit, as far as they apply to \
             this model. {closest}"
    ))
}

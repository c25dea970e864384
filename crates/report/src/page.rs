//! The report: the verdict on one screen, then the evidence.

use super::case::Case;
use super::{findings, head, motion, next, place, ranking, record};
use quell_diagnosis::{Diagnosis, Traces, Verdict};
use quell_page::Page;

/// The whole page, for a model and recordings of these names.
pub fn page(
    diagnosis: &Diagnosis,
    traces: &Traces,
    model_name: &str,
    recording_names: &[String],
) -> Page {
    page_of(&Case::new(diagnosis, traces), model_name, recording_names)
}

/// The whole page of a case.
pub fn page_of(case: &Case, model_name: &str, recording_names: &[String]) -> Page {
    let page = head::head(case, model_name, recording_names).curves(motion::usual(case));
    match case.diagnosis.verdict {
        Verdict::NoMismatch => clean(page, case),
        Verdict::Ambiguous => ambiguous(page, case),
        Verdict::Unexplained => unexplained(page, case),
        Verdict::NotExcited => untold(page, case),
        Verdict::Named | Verdict::PartlyExplained => named(page, case),
    }
}

fn clean(page: Page, case: &Case) -> Page {
    let page = motion::section(page, case);
    let page = ranking::nothing(page, case);
    record::section(page, case)
}

fn named(page: Page, case: &Case) -> Page {
    let page = place::chain(page, case);
    let page = findings::section(page, case);
    let page = motion::section(page, case);
    let page = place::section(page, case);
    let page = ranking::section(page, case);
    let page = next::section(page, case);
    record::section(page, case)
}

/// A page if the fit gives no information: without ranking, and without the search.
fn untold(page: Page, case: &Case) -> Page {
    let page = motion::section(page, case);
    record::section(page, case)
}

fn ambiguous(page: Page, case: &Case) -> Page {
    let page = place::chain(page, case);
    let page = findings::set(page, case);
    let page = next::section(page, case);
    let page = findings::parameters(page, case);
    let page = motion::section(page, case);
    let page = ranking::section(page, case);
    let page = place::section(page, case);
    record::section(page, case)
}

fn unexplained(page: Page, case: &Case) -> Page {
    let page = place::chain(page, case);
    let page = findings::unknown(page, case);
    let page = motion::section(page, case);
    let page = place::section(page, case);
    let page = ranking::section(page, case);
    let page = next::section(page, case);
    record::section(page, case)
}

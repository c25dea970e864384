//! The report: what is wrong with the machine, in half a minute, then the evidence.

use super::shown::{Shown, peak};
use super::{findings, head, motion, next, place, ranking, record};
use crate::diagnosis::{Diagnosis, Traces, Verdict};
use crate::effects::Catalogue;
use crate::report::Page;

/// What all sections are made from.
pub struct Case<'a> {
    /// What is told.
    pub diagnosis: &'a Diagnosis,
    /// What is drawn.
    pub traces: &'a Traces,
    /// Where its effects stand.
    pub catalogue: Catalogue,
}

impl<'a> Case<'a> {
    /// Of a diagnosis that looked through the whole catalogue.
    pub fn new(diagnosis: &'a Diagnosis, traces: &'a Traces) -> Self {
        Self {
            diagnosis,
            traces,
            catalogue: Catalogue::default(),
        }
    }

    /// Whether there is a second model to show.
    pub(super) fn has_after(&self) -> bool {
        !self.diagnosis.findings.is_empty()
    }

    /// The unit of the first output's misfit: that of its motion, or a smaller one.
    pub(super) fn misfit_unit(&self) -> Shown {
        let fit = &self.diagnosis.fit;
        let small = fit.noise_std.max(fit.after.train_rms);
        let first = self
            .traces
            .outputs
            .first()
            .filter(|output| output.unit == fit.unit);
        let large = first.map_or(small, |output| peak(&output.recorded));
        Shown::of(&fit.unit, large).beside(small)
    }
}

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
    let page = head::head(case, model_name, recording_names);
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

/// The fit says nothing: no ranking, and no word on what was looked for.
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

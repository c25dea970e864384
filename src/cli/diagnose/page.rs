//! The report: what is wrong with the machine, in half a minute, then the evidence.

use super::shown::{Shown, peak};
use super::{findings, head, motion, next, place, ranking, record};
use crate::diagnosis::{Diagnosis, Traces, Verdict};
use crate::report::Page;

/// What all sections are made from.
pub(super) struct Case<'a> {
    pub diagnosis: &'a Diagnosis,
    pub traces: &'a Traces,
}

impl Case<'_> {
    /// Whether there is a second model to show.
    pub fn has_after(&self) -> bool {
        !self.diagnosis.findings.is_empty()
    }

    /// The unit of the first output's misfit: that of its motion, or a smaller one.
    pub fn misfit_unit(&self) -> Shown {
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
    let case = Case { diagnosis, traces };
    let page = head::head(&case, model_name, recording_names);
    match diagnosis.verdict {
        Verdict::NoMismatch => clean(page, &case),
        Verdict::Ambiguous => ambiguous(page, &case),
        Verdict::Unexplained => unexplained(page, &case),
        Verdict::NotExcited => untold(page, &case),
        Verdict::Named | Verdict::PartlyExplained => named(page, &case),
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

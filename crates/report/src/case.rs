//! A diagnosis for a report.

use super::shown::{Shown, peak};
use quell_diagnosis::{Diagnosis, Traces};
use quell_model::effects::Catalogue;

/// The data of all sections.
pub struct Case<'a> {
    /// The diagnosis.
    pub diagnosis: &'a Diagnosis,
    /// The series that are drawn.
    pub traces: &'a Traces,
    /// The catalogue of its effects.
    pub catalogue: Catalogue,
}

impl<'a> Case<'a> {
    /// The case of a diagnosis that searched the whole catalogue.
    pub fn new(diagnosis: &'a Diagnosis, traces: &'a Traces) -> Self {
        Self {
            diagnosis,
            traces,
            catalogue: Catalogue::default(),
        }
    }

    /// Whether there is a second model to show.
    pub(crate) fn has_after(&self) -> bool {
        !self.diagnosis.findings.is_empty()
    }

    /// The unit of the first output's misfit: that of its motion, or a smaller one.
    pub(crate) fn misfit_unit(&self) -> Shown {
        let fit = &self.diagnosis.fit;
        let first = self
            .traces
            .outputs
            .first()
            .filter(|output| output.unit == fit.unit);
        let motion = first.map_or(0.0, |output| peak(&output.recorded));
        fit.shown(motion).into()
    }
}

//! A diagnosis that is reported.

use super::shown::{Shown, peak};
use quell_diagnosis::{Diagnosis, Traces};
use quell_model::effects::Catalogue;

/// The case that all sections are made from.
pub struct Case<'a> {
    /// The diagnosis that is told.
    pub diagnosis: &'a Diagnosis,
    /// The series that are drawn.
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

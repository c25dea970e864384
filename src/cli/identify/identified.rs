//! The result of an identification, in all its forms: text, JSON, page, model.

use super::alone::{self, Alone};
use super::printer::{self, Tuned};
use super::refused::of_recording;
use super::{Findings, alone_page, document, model, page, several, tables, words};
use crate::cli::CliError;
use crate::identification::NominalModel;
use crate::identification::stop::Stop;
use crate::page::Page;
use crate::recording::Recording;
use crate::signal::TipRegistration;
use quell_shapers::UncertainMode;
use serde_json::Value;
use std::path::PathBuf;

/// The result for one recording, or for several without a known input.
pub struct Identified(Kind);

enum Kind {
    /// A joint with a known input.
    Driven(Box<Findings>),
    /// Recordings without a known input, and the axes of a printer among them.
    Alone(Vec<Alone>, Vec<Tuned>),
}

impl Identified {
    /// Identifies recordings, each with its file (an empty path without one), until it is stopped.
    ///
    /// # Errors
    /// [`CliError::Input`] where a recording is refused, nothing vibrates, or one of several has a known input.
    pub fn of(
        mut recordings: Vec<(PathBuf, Recording)>,
        model: Option<&NominalModel>,
        registration: TipRegistration,
        stop: Stop,
    ) -> Result<Self, CliError> {
        for (_, recording) in &recordings {
            alone::refuse_rigid(recording)?;
        }
        let driven = match recordings.as_slice() {
            [] => return Err(CliError::input("no recording was given")),
            [(_, one)] => !alone::is_alone(one),
            _ => false,
        };
        if let Some((_, recording)) = recordings.pop_if(|_| driven) {
            let name = recording.name.clone();
            let findings = Findings::of(recording, model, registration, stop);
            let findings = findings.map_err(|error| of_recording(&name, error))?;
            return Ok(Self(Kind::Driven(Box::new(findings))));
        }
        let all = several::identified(&recordings, stop)?;
        let tuned = printer::tune(&all)?;
        Ok(Self(Kind::Alone(all, tuned)))
    }

    /// The tables that the verb prints.
    pub fn text(&self) -> String {
        match &self.0 {
            Kind::Driven(findings) => tables(findings),
            Kind::Alone(all, tuned) => several::text(all, tuned),
        }
    }

    /// The JSON document.
    pub fn document(&self) -> Value {
        match &self.0 {
            Kind::Driven(findings) => document::document(findings),
            Kind::Alone(all, tuned) => several::document(all, tuned),
        }
    }

    /// The report.
    pub fn page(&self) -> Page {
        match &self.0 {
            Kind::Driven(findings) => page::page(findings),
            Kind::Alone(all, tuned) => alone_page::page(all, tuned),
        }
    }

    /// The modes to shape for: the recommended ones or, without a known input, those of the first recording
    /// that are large enough to matter.
    pub fn modes(&self) -> Vec<UncertainMode> {
        match &self.0 {
            Kind::Driven(findings) => {
                let best = findings.found.recommended();
                best.map_or(Vec::new(), |best| best.modes().collect())
            }
            Kind::Alone(all, _) => all.first().map(Alone::shaped_for).unwrap_or_default(),
        }
    }

    /// The texts of the models, one for each recording; `None` for one of which no mode is known.
    pub fn models(&self) -> Vec<Option<String>> {
        match &self.0 {
            Kind::Driven(findings) => {
                let best = findings.found.recommended();
                let text = |best| {
                    let what = words::of_servo(findings);
                    model::of_driven(&findings.recording, &best, what)
                };
                vec![best.map(text)]
            }
            Kind::Alone(all, _) => {
                let text = |one| Some(model::of_alone(one));
                all.iter().map(text).collect()
            }
        }
    }
}

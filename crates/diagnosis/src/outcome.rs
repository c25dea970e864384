//! Input options and results of a diagnosis.

use super::document::Diagnosis;
use super::stop::Stop;
use super::traces::Traces;
use quell_model::effects::{Catalogue, Units};
use quell_model::{Model, Term};

/// Options of the caller.
#[derive(Clone, Debug)]
pub struct Options {
    /// Seed of the bootstrap.
    pub seed: u64,
    /// Effects that the model may lack.
    pub catalogue: Catalogue,
    /// Ends the diagnosis before its time; by default nothing does.
    pub stop: Stop,
    /// Ends the search for further effects with the best explanation so far; by default nothing does. It is
    /// asked before each step of a fit. Of the conclusion only what is short is made after it.
    pub enough: Stop,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            seed: 1,
            catalogue: Catalogue::default(),
            stop: Stop::default(),
            enough: Stop::default(),
        }
    }
}

/// The results of a diagnosis.
pub struct Outcome {
    /// The diagnosis itself.
    pub diagnosis: Diagnosis,
    /// The model with the findings, without events of a single recording.
    pub model: Model,
    /// Events of single recordings.
    pub happened: Vec<Term>,
    /// Series for a report.
    pub traces: Traces,
    /// Units of the model's forces and positions; none where nothing was fitted.
    pub units: Option<Units>,
}

impl Outcome {
    /// The text of the model's file, with the recording's units in its comments.
    pub fn to_toml(&self) -> String {
        match &self.units {
            Some(units) => self.model.to_toml_in(units),
            None => self.model.to_toml(),
        }
    }
}

/// Callback for progress: the finished share of the work, and the present step.
pub type Progress<'a> = &'a (dyn Fn(f64, &str) + Sync);

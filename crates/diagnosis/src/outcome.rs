//! What a diagnosis is asked for, and what it gives.

use super::document::Diagnosis;
use super::stop::Stop;
use super::traces::Traces;
use quell_model::effects::{Catalogue, Units};
use quell_model::{Model, Term};

/// What the caller may choose.
#[derive(Clone, Debug)]
pub struct Options {
    /// Seed of the bootstrap.
    pub seed: u64,
    /// What the model may lack.
    pub catalogue: Catalogue,
    /// Ends the diagnosis before its time; by default nothing does.
    pub stop: Stop,
    /// Ends the search for further effects, and tells the best that was found so far; by default nothing does. It
    /// is asked between the structures that are extended.
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

/// All that a diagnosis gives.
pub struct Outcome {
    /// What it says.
    pub diagnosis: Diagnosis,
    /// The model with the findings in it, but for what happened in one recording.
    pub model: Model,
    /// What happened in one recording.
    pub happened: Vec<Term>,
    /// What a report draws.
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

/// How told: the share of the work that is done, and what is being done.
pub type Progress<'a> = &'a (dyn Fn(f64, &str) + Sync);

//! Diagnosis: where a model and a recording part, and what physics the model lacks.
//!
//! A pure function from a model and recordings to a [`Diagnosis`]; it never sees names of files.

mod baseline;
mod document;
mod fit;
mod noise;
mod problem;
mod screen;
mod split;
mod traces;
mod whitening;

pub use document::{
    Candidate, Diagnosis, Finding, Fit, FittedParameter, Location, NextMove, ProposedMove, Quality,
    Verdict,
};
pub use traces::{CoordinateTrace, OutputTrace, SpectrumTrace, Traces};

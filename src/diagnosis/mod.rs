//! Diagnosis: where a model and a recording part, and what physics the model lacks.
//!
//! A pure function from a model and recordings to a [`Diagnosis`]; it never sees names of files.

mod document;
mod locate;
mod traces;

pub use document::{
    Candidate, Diagnosis, Finding, Fit, FittedParameter, Location, NextMove, ProposedMove, Quality,
    Verdict,
};
pub use locate::{Dynamics, Located, Residual, locate};
pub use traces::{CoordinateTrace, OutputTrace, SpectrumTrace, Traces};

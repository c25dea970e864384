//! The proof: recordings in which something is hidden, made by a simulator that the diagnosis does not
//! know, and the score of what the diagnosis finds in them.
//!
//! [`generate`] makes a case, [`write_cases`] and [`read_cases`] keep a folder of them, [`run`] gives
//! each case's recording to a diagnosis and breaks the seal after the last one, [`Score`] counts.

pub mod families;
mod folder;
mod generator;

mod run;
mod score;
mod truth;
mod verdict;

pub use folder::{
    FolderError, SealedCase, read_cases, read_truths, write_case, write_cases, write_truths,
};
pub use generator::{Case, SHARES, generate};
pub use run::{Diagnose, ProofError, Source, run};
pub use score::{Covered, Judged, Judgement, Kind, Line, Rate, Score, Spread};
pub use truth::{HiddenEffect, Truth, our_name};
pub use verdict::{FindingSummary, ParameterSummary, Verdict};

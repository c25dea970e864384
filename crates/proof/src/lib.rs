#![doc = include_str!("../README.md")]

pub mod families;
mod folder;
mod generator;
mod kind;

mod run;
mod score;
pub mod slots;
mod truth;
mod verdict;

pub use folder::{
    FolderError, SealedCase, read_cases, read_truths, write_case, write_cases, write_truths,
};
pub use generator::{Case, SHARES, generate, generate_kind};
pub use kind::{Kind, UnknownKind};
pub use run::{Diagnose, ProofError, Source, run};
pub use score::{
    Aim, Bin, Covered, Judged, Judgement, KindScore, Line, Rate, Score, ScoreError, Spread,
};
pub use truth::{HiddenEffect, Truth, our_name};
pub use verdict::{Claim, FindingSummary, ParameterSummary, Verdict};

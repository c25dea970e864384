#![doc = include_str!("../README.md")]

mod baseline;
mod basin_hopping;
mod belief;
mod bootstrap;
mod bounds;
mod candidate;
mod conclude;
mod continuation;
mod descent;
mod displacement;
mod document;
mod draw;
mod error;
mod events;
mod evidence;
mod excitation;
mod explanation;
mod extend;
mod fit;
mod found;
mod left;
mod locate;
mod meaning;
mod looks;
mod next_move;
mod noise;
mod noise_colour;
mod normal;
mod outcome;
mod point;
mod pool;
mod prior;
mod problem;
mod quality;
mod remarks;
mod residual_of;
mod run;
mod score;
mod screen;
mod search;
mod settled;
mod split;
mod start;
mod stop;
mod stretches;
mod successive_halving;
mod summary;
mod thresholds;
mod traces;
mod tracker_scale;
mod units;
mod weights;
mod whitening;

pub use baseline::scales;
pub use document::{
    Candidate, Diagnosis, Finding, Fit, FittedParameter, Location, NextMove, ProposedMove, Quality,
    Verdict,
};
pub use error::DiagnosisError;
pub use locate::{Dynamics, Located, Residual, locate};
pub use looks::diagnose;
pub use outcome::{Options, Outcome, Progress};
pub use score::{Predicted, Score, predict, score};
pub use stop::Stop;
pub use traces::{CoordinateTrace, OutputTrace, SpectrumTrace, Traces};

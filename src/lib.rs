//! Adaptive input shaping for flexible robot joints, and diagnosis of what a model of them lacks.
//!
//! The crate gathers the libraries of the workspace under one name.

pub use quell_control::{adaptation, controller, estimators};
pub use quell_diagnosis as diagnosis;
pub use quell_identification as identification;
pub use quell_model as model;
pub use quell_model::effects;
pub use quell_page as page;
pub use quell_proof as proof;
pub use quell_recording as recording;
pub use quell_report as report;
pub use quell_shapers as shapers;
pub use quell_signal as signal;
pub use quell_simulation::{closed_loop, plant};
pub use quell_trajectories as trajectories;

#[cfg(feature = "cli")]
pub mod batch;
#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "serve")]
pub mod service;

//! Adaptive input shaping for flexible robot joints, and diagnosis of what a model of them lacks.
//!
//! The crate gathers the libraries of the workspace under one name:
//!
//! - [`shapers`] and [`trajectories`]: impulse trains, and jerk-limited moves by Ruckig;
//! - [`estimators`], [`adaptation`], [`controller`]: learn a joint's mode while it moves, and retune its shaper;
//! - [`tolerance`]: the fastest move that leaves no more vibration than is allowed;
//! - [`plant`], [`closed_loop`]: simulated arms, and shaped moves of them;
//! - [`recording`], [`signal`]: what was measured, each channel on its own clock;
//! - [`identification`]: frequency and damping from a recording;
//! - [`model`], [`effects`]: models of an axis, and the catalogue of physics that one may lack;
//! - [`rigid_body`]: torque and inertia that each joint of a robot sees along a recorded motion;
//! - [`diagnosis`], [`report`], [`page`]: what a model lacks, told to people;
//! - [`proof`]: recordings in which physics is concealed, and the score of a diagnosis on them.
//!
//! Depend on it with `default-features = false`: the default feature is the command line.
//!
//! # Example
//! ```
//! use quell::closed_loop::{MoveKind, Scenario};
//! use quell::plant::Robot;
//! use quell::shapers::Mode;
//!
//! // The embedded arm has 8.12 Hz; the belief is 25 % off.
//! let comparison = Scenario::new(Robot::rx170(), Mode::from_hertz(10.15, 0.084)?).run()?;
//! assert!(comparison.ratio(MoveKind::AdaptiveNext) < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `examples/` has programs of a few lines: shape a move, identify, diagnose, simulate.

pub use quell_control::{adaptation, controller, estimators, learning, tolerance};
pub use quell_diagnosis as diagnosis;
pub use quell_identification as identification;
pub use quell_model as model;
pub use quell_model::effects;
pub use quell_page as page;
pub use quell_proof as proof;
pub use quell_recording as recording;
pub use quell_report as report;
pub use quell_rigid_body as rigid_body;
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

/// The programs in README and book, run as tests of the documentation.
#[cfg(doctest)]
mod documents {
    #[doc = include_str!("../README.md")]
    struct Readme;
    #[doc = include_str!("../docs/src/guide/library.md")]
    struct Library;
    #[doc = include_str!("../docs/src/guide/shaping.md")]
    struct Shaping;
}

//! The service: commands a real robot in real time, learns its modes, and reports.
//!
//! [`contract`] is all that other parts see of the engine: [`http`] with the page, the [`recorder`], and the
//! [`jobs`] that diagnose recordings.

pub mod between;
pub mod bridged;
pub mod clock;
pub mod config;
pub mod contract;
pub mod demo;
pub mod disk;
mod engine;
mod features;
pub mod following;
#[cfg(feature = "foxglove")]
mod foxglove;
pub mod guard;
pub mod http;
pub mod jobs;
mod keeper;
mod kept;
mod learners;
pub mod link;
pub mod recorder;
mod remembered;
pub mod ringing;
mod shapers;
pub mod signature;
mod start;
pub mod state;
pub mod station;
#[cfg(feature = "nats")]
mod telemetry;
pub mod tick;

pub use features::ZENOH;
pub use start::{Service, start, start_on};
pub use station::StartError;

//! The service: commands a real robot in real time, learns its modes, and tells what it does.
//!
//! [`contract`] is all that the outside sees of the engine: [`http`] with the page, the [`recorder`],
//! and the [`jobs`] that diagnose what was recorded.

pub mod contract;
pub mod http;
pub mod jobs;
pub mod recorder;

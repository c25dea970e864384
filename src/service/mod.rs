//! The service: commands a real robot in real time, learns its modes, and tells what it does.
//!
//! [`contract`] is all that the outside (HTTP, page, files) sees of the engine.

pub mod config;
pub mod contract;

//! Quell: adaptive input shaping for flexible robot joints.
//!
//! Rooms, lowest floor first: [`signal`] and [`recording`], [`estimators`], [`plant`] and
//! [`adaptation`], [`controller`], [`report`], [`cli`]. A room uses only rooms below it.

pub mod adaptation;
pub mod batch;
pub mod cli;
pub mod closed_loop;
pub mod controller;
pub mod diagnosis;
pub mod effects;
pub mod estimators;
pub mod identification;
pub mod model;
pub mod plant;
pub mod proof;
pub mod recording;
pub mod report;
pub mod service;
pub mod signal;

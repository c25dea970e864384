//! Control of a flexible joint: what is measured becomes an estimate of its mode, the estimate a shaper.
//!
//! [`estimators`] learn natural frequency and damping ratio while the robot moves, [`adaptation`] decides
//! whether an estimate is worth acting on, and [`controller`] runs both at the tick and shapes the planned
//! motion. Nothing here allocates, blocks or fails at the tick.

pub mod adaptation;
pub mod controller;
pub mod estimators;

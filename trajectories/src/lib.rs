#![doc = include_str!("../README.md")]

mod axis;
mod between;
mod brake;
mod check;
mod closed_form;
mod cruise;
mod dip;
mod error;
mod given;
mod path;
mod planner;
mod problem;
mod profile;
mod ramp;
mod rate;
mod read_back;
mod rest;
mod sampled;
mod solver;
mod stop;
mod trajectory;

pub use axis::{AxisState, Limits, MAX_DEGREES_OF_FREEDOM};
pub use brake::Brake;
pub use error::PlanError;
pub use planner::Planner;
pub use profile::{AxisProfile, Phase};
pub use rate::{Progress, RateRamp};
pub use sampled::{MAX_SAMPLES, SampledTrajectory};
pub use trajectory::Trajectory;

//! The axis as a chain: servo, transmission, link, sensors.

pub mod arm;
mod axis;
pub mod error;
pub mod log;
pub mod options;
pub mod robot;
mod robot_file;

pub use arm::{ArmSimulation, Command, Load};
pub use error::{RobotError, SimulationError};
pub use log::MeasurementLog;
pub use options::SimulationOptions;
pub use robot::{Damping, DefaultMove, Encoder, ModeOfJoint, Robot, RobotJoint, Servo, Tracker};

//! The axis as a chain: servo, transmission, link, sensors.

pub mod arm;
mod axis;
pub mod log;
pub mod robot;
mod robot_file;

pub use arm::{ArmSimulation, Command, SimulationError, SimulationOptions};
pub use log::MeasurementLog;
pub use robot::{
    Damping, DefaultMove, Encoder, JointLimits, ModeOfJoint, Robot, RobotJoint, Servo, Tracker,
};
pub use robot_file::RobotError;

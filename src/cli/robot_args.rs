//! Arguments for the joint, its robot, and the simulation of its arm.

use std::path::{Path, PathBuf};

use super::{CliError, choices, values};
use crate::plant::{Damping, Robot, SimulationOptions};
use crate::signal::JointKind;

/// Which joint of which robot.
#[derive(Debug, clap::Args)]
pub struct RobotArgs {
    /// The robot's description; the embedded arm where none is given.
    #[arg(long, value_name = "FILE")]
    pub robot: Option<PathBuf>,
    /// The joint, counted from 1 [default: the one that the description moves].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub joint: Option<usize>,
}

impl RobotArgs {
    /// The robot, and the joint counted from 0.
    ///
    /// # Errors
    /// [`CliError::Input`] where the description is refused, or the robot has no such joint, or one
    /// that slides.
    pub fn resolve(&self) -> Result<(Robot, usize), CliError> {
        let robot = robot(self.robot.as_deref())?;
        let joint = self.joint_of(&robot)?;
        Ok((robot, joint))
    }

    /// The joint of `robot`, counted from 0.
    ///
    /// # Errors
    /// As [`Self::resolve`].
    pub fn joint_of(&self, robot: &Robot) -> Result<usize, CliError> {
        let Some(number) = self.joint else {
            return Ok(robot.default_move.joint);
        };
        let joints = robot.chain.joints();
        let index = number.checked_sub(1);
        match index.and_then(|index| Some((index, joints.get(index)?.kind))) {
            Some((index, JointKind::Revolute)) => Ok(index),
            Some((_, JointKind::Prismatic)) => Err(CliError::input(format!(
                "--joint {number}: it slides; a joint that turns is needed"
            ))),
            None => Err(CliError::input(format!(
                "--joint {number}: {} has joints 1 to {}",
                robot.name,
                joints.len()
            ))),
        }
    }
}

/// The robot of a description; the embedded arm without one.
///
/// # Errors
/// [`CliError::Input`] with file, key and value.
pub fn robot(file: Option<&Path>) -> Result<Robot, CliError> {
    match file {
        Some(file) => Robot::from_file(file).map_err(CliError::input),
        None => Ok(Robot::rx170()),
    }
}

/// Deviations of the simulated arm from its description.
#[derive(Debug, clap::Args)]
pub struct SimulationArgs {
    /// Load at the tip, kg; what is believed of the joint does not know of it.
    #[arg(long, value_name = "KG", default_value_t = 0.0, value_parser = values::size,
          allow_negative_numbers = true)]
    pub payload: f64,
    /// Where the damper sits [default: as the description says].
    #[arg(long, value_parser = choices::dampings())]
    pub damping: Option<Damping>,
    /// Noise of the tracker, one standard deviation, um [default: the robot's].
    #[arg(long, visible_alias = "noise-um", value_name = "UM", value_parser = values::size,
          allow_negative_numbers = true)]
    pub noise: Option<f64>,
    /// Seed of the simulated noise.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
}

impl SimulationArgs {
    /// The options of the simulation, in SI.
    pub fn options(&self) -> SimulationOptions {
        SimulationOptions {
            seed: self.seed,
            payload: self.payload,
            tracker_noise: self.noise.map(|um| um * 1e-6),
            damping: self.damping,
            ..SimulationOptions::default()
        }
    }
}

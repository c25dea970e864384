//! The setup that the arguments ask for: the robot, its joint, pose and modes, and the belief.

use quell_shapers::Mode;

use super::Args;
use crate::cli::CliError;
use crate::plant::{Damping, ModeOfJoint, Robot, SimulationOptions};
use crate::signal::JointKind;

/// A joint of a robot, with its simulation and its believed modes.
pub struct Setup {
    /// The robot.
    pub robot: Robot,
    /// Counted from 0.
    pub joint: usize,
    /// Positions of the joints at the start, rad or m.
    pub pose: Vec<f64>,
    /// Modes in the home pose without payload.
    pub modes: Vec<ModeOfJoint>,
    /// The modes that shapers and the model file are made for, the first mode first.
    pub belief: Vec<Mode>,
    /// Options of its simulation.
    pub options: SimulationOptions,
}

impl Setup {
    /// The scenario that the arguments ask for.
    ///
    /// # Errors
    /// [`CliError::Input`] that names the argument or the key of the robot's description.
    pub fn from(args: &Args) -> Result<Self, CliError> {
        let (robot, joint) = args.robot.resolve()?;
        let modes = modes(args, &robot, joint);
        let belief = match args.belief.as_slice() {
            [] => modes.iter().map(|entry| entry.mode).collect(),
            given => given.to_vec(),
        };
        let options = SimulationOptions {
            modes: Some(modes.clone()),
            ..args.simulation.options()
        };
        Ok(Self {
            pose: pose(args, &robot)?,
            robot,
            joint,
            modes,
            belief,
            options,
        })
    }

    /// Half a period of the slowest mode, or of the servo if that is slower: within it a free oscillation
    /// reaches its greatest deflection.
    pub fn half_period(&self) -> f64 {
        let frequencies = self
            .modes
            .iter()
            .map(|entry| entry.mode.natural_frequency());
        core::f64::consts::PI / frequencies.fold(self.robot.servo.bandwidth, f64::min)
    }

    /// Rest after each move, s.
    pub fn dwell(&self, args: &Args) -> f64 {
        let slowest = self.modes.iter().map(|entry| 1.0 / entry.mode.hertz());
        let default = || f64::max(1.0, 12.0 * slowest.fold(0.0, f64::max));
        args.dwell.unwrap_or_else(default)
    }
}

/// The joint's modes, the first one replaced by --mode; a stiff joint gets its first from there.
fn modes(args: &Args, robot: &Robot, joint: usize) -> Vec<ModeOfJoint> {
    let mut modes = robot.joints[joint].modes.clone();
    match (args.mode, modes.first_mut()) {
        (Some(mode), Some(first)) => first.mode = mode,
        (Some(mode), None) => modes.push(ModeOfJoint {
            mode,
            damping: Damping::AcrossJoint,
            participation: 1.0,
        }),
        (None, _) => {}
    }
    modes
}

fn pose(args: &Args, robot: &Robot) -> Result<Vec<f64>, CliError> {
    if args.pose.is_empty() {
        return Ok(robot.home());
    }
    let (given, joints) = (args.pose.len(), robot.joints.len());
    if given != joints {
        return Err(CliError::input(format!(
            "--pose: {given} values for the {joints} joints of {}",
            robot.name
        )));
    }
    if let Some(value) = args.pose.iter().find(|value| !value.is_finite()) {
        return Err(CliError::input(format!(
            "--pose: {value} is not a finite number"
        )));
    }
    let kinds = robot.chain.joints().iter().map(|joint| joint.kind);
    let values = args.pose.iter().zip(kinds).map(|(value, kind)| match kind {
        JointKind::Revolute => value.to_radians(),
        JointKind::Prismatic => *value,
    });
    Ok(values.collect())
}

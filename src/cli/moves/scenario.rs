//! What the arguments ask for.

use quell_shapers::{Mode, shaper_by_name};
use quell_trajectories::Limits;

use super::Args;
use crate::cli::{CliError, choices};
use crate::closed_loop::Scenario;
use crate::estimators::estimator;
use crate::plant::{JointLimits, Robot, SimulationOptions};

/// The scenario of the arguments.
///
/// # Errors
/// [`CliError::Input`] that names the argument or the key of the robot's description.
pub fn from(args: &Args) -> Result<Scenario, CliError> {
    let robot = match &args.robot {
        Some(file) => Robot::from_file(file).map_err(CliError::input)?,
        None => Robot::rx170(),
    };
    let joint = joint(args, &robot)?;
    let belief = belief(args, &robot, joint)?;
    Ok(Scenario {
        displacement: displacement(args, &robot)?,
        limits: limits(args, robot.joints[joint].limits),
        simulation: SimulationOptions {
            seed: args.seed,
            payload: args.payload,
            tracker_noise: args.noise.map(|um| um * 1e-6),
            damping: args.damping.as_deref().and_then(choices::damping),
            ..SimulationOptions::default()
        },
        belief,
        shaper: shaper_by_name(&args.shaper)
            .ok_or_else(|| CliError::input(format!("there is no shaper {:?}", args.shaper)))?,
        estimator: estimator(&args.estimator).ok_or_else(|| {
            CliError::input(format!("there is no estimator {:?}", args.estimator))
        })?,
        joint,
        robot,
    })
}

fn joint(args: &Args, robot: &Robot) -> Result<usize, CliError> {
    let Some(number) = args.joint else {
        return Ok(robot.default_move.joint);
    };
    let joints = robot.joints.len();
    if !(1..=joints).contains(&number) {
        let text = format!("--joint {number}: {} has joints 1 to {joints}", robot.name);
        return Err(CliError::input(text));
    }
    Ok(number - 1)
}

/// The mode that is believed in: given, or the joint's own with a wrong frequency.
fn belief(args: &Args, robot: &Robot, joint: usize) -> Result<Mode, CliError> {
    let Some(own) = robot.joints[joint].modes.first() else {
        let text = format!(
            "joint {} of {} has no mode: it does not ring",
            joint + 1,
            robot.name
        );
        return Err(CliError::input(text).with_help(
            "give the joint a line mode = [{ frequency_hz = .., damping_ratio = .. }]",
        ));
    };
    if let Some(belief) = args.belief {
        return Ok(belief);
    }
    let factor = 1.0 + args.belief_error / 100.0;
    Mode::new(
        own.mode.natural_frequency() * factor,
        own.mode.damping_ratio(),
    )
    .map_err(|error| CliError::input(format!("--belief-error {}: {error}", args.belief_error)))
}

fn displacement(args: &Args, robot: &Robot) -> Result<f64, CliError> {
    let displacement = args
        .target
        .map_or(robot.default_move.target, f64::to_radians);
    if displacement.is_finite() && displacement != 0.0 {
        return Ok(displacement);
    }
    Err(CliError::input(format!(
        "--target {}: a move needs a finite displacement other than 0 deg",
        displacement.to_degrees()
    )))
}

fn limits(args: &Args, own: JointLimits) -> Limits {
    let pick = |given: Option<f64>, own: f64| given.map_or(own, f64::to_radians);
    Limits {
        velocity: pick(args.velocity, own.velocity),
        acceleration: pick(args.acceleration, own.acceleration),
        jerk: pick(args.jerk, own.jerk),
    }
}

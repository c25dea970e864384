//! What the arguments ask for.

use quell_shapers::Mode;
use quell_trajectories::Limits;

use super::Args;
use crate::cli::CliError;
use crate::closed_loop::Scenario;
use crate::plant::Robot;

/// The longest period that a belief may have, s. A move and its decay are simulated for 20 s, and the
/// longest shaper lasts two periods.
const LONGEST_PERIOD: f64 = 10.0;

/// The scenario of the arguments.
///
/// # Errors
/// [`CliError::Input`] that names the argument or the key of the robot's description.
pub fn from(args: &Args) -> Result<Scenario, CliError> {
    let (robot, joint) = args.robot.resolve()?;
    let belief = belief(args, &robot, joint)?;
    if belief.damped_period() > LONGEST_PERIOD {
        return Err(CliError::input(format!(
            "a belief of {:e} Hz: a period of more than {LONGEST_PERIOD} s is not simulated",
            belief.hertz()
        )));
    }
    Ok(Scenario {
        displacement: displacement(args, &robot)?,
        limits: limits(args, robot.joints[joint].limits),
        simulation: args.simulation.options(),
        belief,
        shaper: args.shaper,
        estimator: args.estimator,
        joint,
        robot,
    })
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
            "give the joint a line mode = [{ frequency_hz = .., damping_ratio = .., damping = \"across_joint\" }]",
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
    match displacement {
        0.0 => Err(CliError::input("--target 0: a move needs a displacement")),
        _ => Ok(displacement),
    }
}

fn limits(args: &Args, own: Limits) -> Limits {
    let pick = |given: Option<f64>, own: f64| given.map_or(own, f64::to_radians);
    Limits {
        velocity: pick(args.velocity, own.velocity),
        acceleration: pick(args.acceleration, own.acceleration),
        jerk: pick(args.jerk, own.jerk),
    }
}

//! The scenario that the arguments ask for.

use quell_shapers::Mode;
use quell_trajectories::Limits;

use super::Args;
use crate::cli::CliError;
use crate::closed_loop::Scenario;
use crate::plant::Robot;

/// The longest period that a belief may have, s. A move and its decay are simulated for 20 s, and the
/// longest shaper lasts two periods.
const LONGEST_PERIOD: f64 = 10.0;
/// The fewest ticks in a damped period: shapers take two in half of it.
const FEWEST_TICKS: f64 = 4.0;

/// The scenario of the arguments.
///
/// # Errors
/// [`CliError::Input`] that names the argument or the key of the robot's description.
pub fn from(args: &Args) -> Result<Scenario, CliError> {
    let (robot, joint) = args.robot.resolve()?;
    let belief = belief(args, &robot, joint)?;
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

/// The believed mode of a joint that vibrates.
fn belief(args: &Args, robot: &Robot, joint: usize) -> Result<Mode, CliError> {
    belief_of(args, robot, joint)?.ok_or_else(|| {
        let text = format!(
            "joint {} of {} has no mode: it does not ring",
            joint + 1,
            robot.name
        );
        CliError::input(text).with_help(
            "give the joint a line mode = [{ frequency_hz = .., damping_ratio = .., damping = \"across_joint\" }]",
        )
    })
}

/// The believed mode: given, or the joint's own with a wrong frequency; `None` for a stiff joint.
pub(super) fn belief_of(
    args: &Args,
    robot: &Robot,
    joint: usize,
) -> Result<Option<Mode>, CliError> {
    let Some(own) = robot.joints[joint].modes.first() else {
        return Ok(None);
    };
    let wrong = || {
        let factor = 1.0 + args.belief_error / 100.0;
        let frequency = own.mode.natural_frequency() * factor;
        Mode::new(frequency, own.mode.damping_ratio()).map_err(|error| {
            CliError::input(format!("--belief-error {}: {error}", args.belief_error))
        })
    };
    let belief = args.belief.map_or_else(wrong, Ok)?;
    let periods = FEWEST_TICKS / robot.control_rate..=LONGEST_PERIOD;
    if periods.contains(&belief.damped_period()) {
        return Ok(Some(belief));
    }
    let option = match args.belief {
        Some(_) => "--belief".to_owned(),
        None => format!("--belief-error {:e}", args.belief_error),
    };
    let hertz = belief.hertz();
    let [low, high] = [periods.end(), periods.start()].map(|period| 1.0 / period);
    Err(CliError::input(format!(
        "{option}: the damped frequency of a belief of {hertz:e} Hz is not from {low} to {high} Hz"
    )))
}

fn displacement(args: &Args, robot: &Robot) -> Result<f64, CliError> {
    match args.target[..] {
        [] => Ok(robot.default_move.target),
        [0.0] => Err(CliError::input("--target 0: a move needs a displacement")),
        [target] => Ok(target.to_radians()),
        [..] => {
            let text = format!(
                "--target: {} targets, and one joint that moves",
                args.target.len()
            );
            Err(CliError::input(text).with_help("add --path to move several joints at once"))
        }
    }
}

/// The limits of the arguments, or else those of the joint.
pub(super) fn limits(args: &Args, own: Limits) -> Limits {
    let pick = |given: Option<f64>, own: f64| given.map_or(own, f64::to_radians);
    Limits {
        velocity: pick(args.velocity, own.velocity),
        acceleration: pick(args.acceleration, own.acceleration),
        jerk: pick(args.jerk, own.jerk),
    }
}

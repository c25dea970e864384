//! `quell move`: the same move unshaped, shaped by a wrong belief, and adaptive.

mod document;
mod files;
mod page;
mod path;
mod scenario;

use std::path::{Path, PathBuf};

use quell_shapers::{Mode, Shaper};

use super::out::Force;
use super::robot_args::{RobotArgs, SimulationArgs};
use super::{CliError, choices, output, shaping, values};
use crate::closed_loop::{ClosedLoopError, Comparison, MoveKind, MoveTrace, Scenario};
use crate::estimators::EstimatorEntry;
use crate::tolerance::{Tolerance, ToleranceError};

/// Makes one move unshaped, shaped by a wrong belief, adaptive, and adaptive on the next move.
///
/// Without arguments: the embedded arm, 30 degrees, its frequency believed 25 % too high.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell move
  quell move --belief-error -20 --shaper ei --noise 20 --seed 7
  quell move --robot robot.toml --joint 2 --target 45 --belief 11,0.05 --json
  quell move --robot robot.toml --target 30,45 --path
  quell move --residual 5 --deviation 0.2

Residual: peak of the true deformation at the tip once the command has ended and the motor side has \
followed. Settling: from the start of the move until the tip stays within 0.05 mm of its target. \
Delay: what shaping and corrections add to the command. The tracker's frame and clock are learned \
first, in a commissioning move there and back. The folder of --out gets report.html and a recording \
of each move that `quell identify` and `quell inspect` read.

With --path several joints move at once, on a straight line in joint space: unshaped, each with a \
shaper of its own, and each with the shapers of all joints in series, which keeps the line. The latter \
two are made twice: a first move, and the next one with what was learned.

--residual and --deviation add the first move once more, as fast as both allow. They hold for all \
modes within two standard deviations of the learned ones. No train is then sent. The deviation is the \
distance of the commanded tip from the straight line in joint space, and the amplitude at the tip after the \
end; without it several joints keep the line.")]
pub struct Args {
    #[command(flatten)]
    robot: RobotArgs,
    /// How far to move, deg [default: as the description says, 30]. With --path of every joint, from
    /// joint 1 on: 30,45.
    #[arg(
        long,
        visible_alias = "target-deg",
        value_name = "DEG",
        value_delimiter = ',',
        value_parser = values::angle,
        allow_negative_numbers = true
    )]
    pub target: Vec<f64>,
    /// Moves several joints on a straight line in joint space.
    #[arg(long, requires = "target", conflicts_with_all = ["joint", "belief"])]
    pub path: bool,
    /// The believed mode: natural frequency in Hz and damping ratio.
    #[arg(long, value_name = "F,XI", value_parser = values::mode, allow_hyphen_values = true, conflicts_with = "belief_error")]
    pub belief: Option<Mode>,
    /// How wrong the believed frequency is, percent of the true one.
    #[arg(
        long,
        value_name = "PERCENT",
        default_value_t = 25.0,
        value_parser = values::frequency_error,
        allow_negative_numbers = true
    )]
    pub belief_error: f64,
    /// The shaper.
    #[arg(long, default_value = "zvd", value_parser = choices::shapers())]
    pub shaper: &'static dyn Shaper,
    /// The estimator.
    #[arg(long, default_value = "likelihood", value_parser = choices::estimators())]
    pub estimator: &'static EstimatorEntry,
    /// Limit of the velocity, deg/s [default: the joint's].
    #[arg(long, value_name = "DEG/S", value_parser = values::limit,
          allow_negative_numbers = true)]
    pub velocity: Option<f64>,
    /// Limit of the acceleration, deg/s^2 [default: the joint's].
    #[arg(long, value_name = "DEG/S^2", value_parser = values::limit,
          allow_negative_numbers = true)]
    pub acceleration: Option<f64>,
    /// Limit of the jerk, deg/s^3 [default: the joint's].
    #[arg(long, value_name = "DEG/S^3", value_parser = values::limit,
          allow_negative_numbers = true)]
    pub jerk: Option<f64>,
    /// Adds the move as fast as it may be when it leaves so much vibration, percent of the unshaped.
    #[arg(long, value_name = "PERCENT", value_parser = values::residual, allow_negative_numbers = true)]
    pub residual: Option<f64>,
    /// Adds the move as fast as it may be when the tip leaves its path, or vibrates at its end, by so much, mm.
    #[arg(long, value_name = "MM", value_parser = values::limit, allow_negative_numbers = true)]
    pub deviation: Option<f64>,
    #[command(flatten)]
    simulation: SimulationArgs,
    /// The folder for report and recordings.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    force: Force,
    /// Prints JSON instead of a table.
    #[arg(long)]
    pub json: bool,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where the robot, the belief or the move is refused.
pub fn run(args: Args) -> Result<(), CliError> {
    if args.path {
        return path::run(&args);
    }
    let reads: Vec<&Path> = args.robot.robot.as_deref().into_iter().collect();
    let out = files::open(&args.out, args.force, &reads)?;
    let scenario = scenario::from(&args)?;
    let comparison = side_by_side(&scenario, shaping::tolerance(args.residual, args.deviation))?;
    files::write(&out, &scenario, &comparison)?;
    let report = args.out.join(files::REPORT);
    if args.json {
        return output::json(&document::document(&comparison));
    }
    output::text(&document::text(&scenario, &comparison))?;
    let next = files::next_command(&args.out);
    output::text(&format!("\nReport: {}\n{next}", report.display()))
}

/// Largest distance of an ended command from its target, rad: rounding.
const AT_TARGET: f64 = 1e-9;

/// Refuses a move that was cut off: its residual would be meaningless.
fn finished(name: &str, trace: &MoveTrace) -> Result<(), CliError> {
    if trace.final_error() <= AT_TARGET {
        return Ok(());
    }
    let longest = trace.ticks.last().map_or(0.0, |tick| tick.time);
    let text = format!("the move {name} has not ended after {longest:.0} s, the longest simulated");
    Err(CliError::input(text)
        .with_help("a shorter --target, higher limits, or a --belief of a higher frequency"))
}

/// Runs the three control cells side by side, as they are independent.
fn side_by_side(scenario: &Scenario, tolerance: Option<Tolerance>) -> Result<Comparison, CliError> {
    let (unshaped, (wrong_belief, adaptive)) = rayon::join(
        || named(scenario.shaper, || scenario.unshaped()),
        || {
            rayon::join(
                || named(scenario.shaper, || scenario.wrong_belief()),
                || named(scenario.shaper, || scenario.adaptive()),
            )
        },
    );
    let [unshaped, wrong_belief] = [unshaped?, wrong_belief?];
    finished(MoveKind::Unshaped.name(), &unshaped)?;
    finished(MoveKind::WrongBelief.name(), &wrong_belief)?;
    let (first, next, truth) = adaptive?;
    finished(MoveKind::AdaptiveFirst.name(), &first)?;
    finished(MoveKind::AdaptiveNext.name(), &next)?;
    let modes = next.known_modes();
    let adaptive = (first, next, truth);
    let comparison = Comparison::new(unshaped, wrong_belief, adaptive);
    let Some(tolerance) = tolerance else {
        return Ok(comparison);
    };
    let within = scenario.within(tolerance, modes).map_err(refused)?;
    finished(MoveKind::WithinTolerance.name(), &within.0)?;
    Ok(comparison.with_tolerance(within))
}

/// A simulation, named in the log by its shaper.
fn named<T>(
    shaper: &dyn Shaper,
    run: impl FnOnce() -> Result<T, ClosedLoopError>,
) -> Result<T, CliError> {
    let _span = tracing::info_span!("cell", shaper = shaper.name()).entered();
    run().map_err(refused)
}

fn refused(error: ClosedLoopError) -> CliError {
    let help = match &error {
        ClosedLoopError::Registration(_) => {
            "a move of its own first tells where the tracker stands: it takes a longer --target, \
             less --noise, less --payload or a faster tracker"
        }
        ClosedLoopError::Tolerance(ToleranceError::Unattainable { .. }) => {
            "allow more by --residual or --deviation, or let the modes be better known: less --noise"
        }
        _ => return CliError::input(error),
    };
    CliError::input(error).with_help(help)
}

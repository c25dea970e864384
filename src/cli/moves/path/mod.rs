//! `quell move --path`: several joints on a straight line in joint space, with separate trains and with a
//! common one.

mod document;
mod files;
mod page;

use std::path::Path;

use quell_shapers::UncertainMode;

use super::{Args, finished, named, refused, scenario};
use crate::cli::{CliError, output, shaping};
use crate::closed_loop::{PathComparison, PathJoint, PathKind, PathScenario, PathTrace};
use crate::plant::Robot;
use crate::signal::JointKind;
use crate::tolerance::Tolerance;

/// Runs the verb with `--path`.
///
/// # Errors
/// [`CliError::Input`] where the robot, a belief or the move is refused.
pub fn run(args: &Args) -> Result<(), CliError> {
    let scenario = from(args)?;
    let reads: Vec<&Path> = args.robot.robot.as_deref().into_iter().collect();
    let out = files::open(&args.out, args.force, &reads, &scenario)?;
    let comparison = side_by_side(&scenario, shaping::tolerance(args.residual, args.deviation))?;
    files::write(&out, &scenario, &comparison)?;
    if args.json {
        return output::json(&document::document(&scenario, &comparison));
    }
    output::text(&document::text(&scenario, &comparison))?;
    let report = args.out.join(files::REPORT);
    let next = files::next_command(&args.out, &scenario);
    output::text(&format!("\nReport: {}\n{next}", report.display()))
}

/// The scenario of the arguments.
fn from(args: &Args) -> Result<PathScenario, CliError> {
    let robot = super::super::robot_args::robot(args.robot.robot.as_deref())?;
    let joints = joints(args, &robot)?;
    if joints.iter().all(|joint| joint.belief.is_none()) {
        let text = format!(
            "no joint of {} that moves has a mode: none rings",
            robot.name
        );
        return Err(CliError::input(text));
    }
    Ok(PathScenario {
        joints,
        simulation: args.simulation.options(),
        shaper: args.shaper,
        estimator: args.estimator,
        robot,
    })
}

/// The joints that move, at least two.
fn joints(args: &Args, robot: &Robot) -> Result<Vec<PathJoint>, CliError> {
    let chain = robot.chain.joints();
    if args.target.len() > chain.len() {
        let text = format!(
            "--target: {} targets, and {} has joints 1 to {}",
            args.target.len(),
            robot.name,
            chain.len()
        );
        return Err(CliError::input(text));
    }
    let mut joints = Vec::new();
    for (joint, target) in args
        .target
        .iter()
        .enumerate()
        .filter(|(_, target)| **target != 0.0)
    {
        if chain[joint].kind == JointKind::Prismatic {
            let text = format!(
                "--target: joint {} slides; only joints that turn can move",
                joint + 1
            );
            return Err(CliError::input(text).with_help("a target of 0 leaves it where it stands"));
        }
        let own = robot.joints[joint].limits;
        joints.push(PathJoint {
            joint,
            displacement: target.to_radians(),
            limits: scenario::limits(args, own),
            belief: scenario::belief_of(args, robot, joint)?,
        });
    }
    match joints.len() {
        0 | 1 => Err(CliError::input("--path: at least two joints must move")
            .with_help("--target takes one angle for each joint, from joint 1 on: --target 30,45")),
        _ => Ok(joints),
    }
}

/// Runs the control cells of each way to shape side by side, as they are independent.
fn side_by_side(
    scenario: &PathScenario,
    tolerance: Option<Tolerance>,
) -> Result<PathComparison, CliError> {
    let (unshaped, (own, common)) = rayon::join(
        || named(scenario.shaper, || scenario.unshaped()),
        || {
            rayon::join(
                || named(scenario.shaper, || scenario.own_trains()),
                || named(scenario.shaper, || scenario.common_train()),
            )
        },
    );
    // A move that was cut off is reported before its consequences in the next.
    let unshaped = unshaped?;
    all_finished(PathKind::Unshaped, &unshaped)?;
    let mut comparison = PathComparison::new(unshaped, own?, common?);
    if let Some(tolerance) = tolerance {
        let modes = known_modes(scenario, comparison.trace(PathKind::OwnTrainsNext));
        let within = scenario.within(tolerance, &modes).map_err(refused)?;
        comparison = comparison.with_tolerance(within);
    }
    for (kind, trace) in &comparison.moves {
        all_finished(*kind, trace)?;
    }
    Ok(comparison)
}

/// The known modes of each joint after a move; empty for a stiff joint.
fn known_modes(scenario: &PathScenario, trace: &PathTrace) -> Vec<Vec<UncertainMode>> {
    let each = scenario.joints.iter().zip(&trace.joints);
    let modes = each.map(|(joint, trace)| match joint.belief {
        Some(_) => trace.known_modes(),
        None => Vec::new(),
    });
    modes.collect()
}

fn all_finished(kind: PathKind, trace: &PathTrace) -> Result<(), CliError> {
    let mut joints = trace.joints.iter();
    joints.try_for_each(|joint| finished(kind.name(), joint))
}

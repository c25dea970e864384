//! `quell compare`: the residual vibration of each shaper when a robot's frequency is wrongly known, and a
//! recommendation.

mod candidate;
mod choice;
mod page;
mod print;
mod trial;

use super::mode_args::ModeArgs;
use super::out::{Force, Out};
use super::progress::Progress;
use super::robot_args::{RobotArgs, robot};
use super::{CliError, next, output, shaping, values};
use crate::identification::ToldMode;
use crate::page::number;
use crate::plant::Robot;
use candidate::{Candidate, Design};
use choice::{Advice, Choice, Wish};
use quell_shapers::{GridTrain, Mode, Shaper, UncertainMode};
use serde_json::json;
use std::path::{Path, PathBuf};
use trial::{Simulated, Trial};

/// Frequency errors in the table.
const ERRORS: [f64; 5] = [-0.25, -0.10, 0.0, 0.10, 0.25];
/// How well a frequency is known of which nothing tells it, one standard deviation in percent of it; and a damping ratio.
const FREQUENCY_STD: f64 = 10.0;
const DAMPING_STD: f64 = 0.02;
/// Name of the report.
const REPORT: &str = "compare.html";
/// Points of a curve on either side of no error.
const POINTS: usize = 60;

/// Compares all shapers over a spread of frequency errors and recommends one.
#[derive(clap::Args)]
#[command(mut_group("modes", |group| group.conflicts_with("joint")))]
#[command(after_help = "\
Examples:
  quell compare                              the embedded arm
  quell compare robot.toml --joint 2 --out out
  quell compare --model out/model.toml --rate 1000
  quell compare --recording arm7 --rate 1000
  quell compare --mode 8.12,0.084 --rate 1000 --frequency-std 5 --max-delay 0.1 --json

V is the residual vibration: the amplitude that the shaped command leaves over what the unshaped \
one leaves, each at its own end; the columns give it for a machine whose frequency is that much \
above (+) or below (-) the believed one, and for one that is known only so well (--frequency-std, \
--damping-std): V 95 % stays below that value with 95 % probability. Insensitivity: width of the \
band with V <= 5 %, over the frequency. Delay: what the shaper adds to the end of a move. The \
millimetres are simulated: the greatest tip deformation after the robot's own move.

Recommended is the shortest shaper within --max-delay whose V 95 % is --acceptable; where none is, \
the one that leaves least. umzv never is: its negative impulses can exceed the limits of a move. \
Several modes are shaped for by one shaper, one train after the other, and the worst mode counts. Writes \
compare.html into --out.")]
pub struct Args {
    /// The robot's description, as --robot; the embedded arm where none is given.
    #[arg(value_name = "ROBOT", conflicts_with = "robot")]
    file: Option<PathBuf>,
    #[command(flatten)]
    robot: RobotArgs,
    #[command(flatten)]
    modes: ModeArgs,
    /// Commands a second [default: the robot's].
    #[arg(long, value_name = "HZ", value_parser = values::positive, allow_negative_numbers = true)]
    rate: Option<f64>,
    /// How well the frequency is known: one standard deviation, percent of it [default: what --model or --recording
    /// tells, else 10].
    #[arg(long, value_name = "PERCENT", value_parser = deviation, allow_negative_numbers = true)]
    frequency_std: Option<f64>,
    /// How well the damping ratio is known: one standard deviation, as a ratio such as 0.02 [default: what --model or
    /// --recording tells, else 0.02].
    #[arg(long, value_name = "RATIO", value_parser = damping_deviation,
          allow_negative_numbers = true)]
    damping_std: Option<f64>,
    /// The residual vibration that is small enough, percent of the unshaped one.
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0,
          value_parser = values::below_100_percent, allow_negative_numbers = true)]
    acceptable: f64,
    /// The longest delay that the recommended shaper may add, s [default: any].
    #[arg(long, value_name = "S", value_parser = values::not_negative,
          allow_negative_numbers = true)]
    max_delay: Option<f64>,
    /// How far the curves reach on either side, percent.
    #[arg(long, value_name = "PERCENT", default_value_t = 30.0,
          value_parser = values::below_100_percent, allow_negative_numbers = true)]
    spread: f64,
    /// The folder for the report.
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    #[command(flatten)]
    force: Force,
    /// Prints JSON instead of tables.
    #[arg(long)]
    json: bool,
}

impl Args {
    /// The robot's description, where one is given.
    fn robot_file(&self) -> Option<&Path> {
        self.file.as_deref().or(self.robot.robot.as_deref())
    }
}

/// The standard deviation of a frequency: two of them below it a positive frequency must remain.
fn deviation(text: &str) -> Result<f64, String> {
    let percent = values::below_100_percent(text).ok();
    let percent = percent.filter(|percent| *percent < 50.0);
    percent.ok_or_else(|| "it is not a percentage from 0 to below 50".into())
}

/// The standard deviation of a damping ratio, below 1 as the ratio itself.
fn damping_deviation(text: &str) -> Result<f64, String> {
    let ratio = values::not_negative(text).ok();
    let ratio = ratio.filter(|ratio| *ratio < 1.0);
    ratio.ok_or_else(|| "it is not a ratio from 0 to below 1".into())
}

/// The compared shapers, and the modes that they are compared for.
struct Comparison {
    machine: String,
    modes: Vec<UncertainMode>,
    rate: f64,
    spread: f64,
    candidates: Vec<Candidate>,
    wish: Wish,
    advice: Advice,
    /// The unshaped move, where the robot was simulated.
    unshaped: Option<Simulated>,
    /// Remarks on the simulated moves.
    remarks: Vec<String>,
}

impl Comparison {
    fn designs(&self) -> impl Iterator<Item = (&'static dyn Shaper, &Design)> {
        self.candidates
            .iter()
            .filter_map(|candidate| Some((candidate.shaper, candidate.design.as_ref().ok()?)))
    }

    fn choice(&self) -> Option<&Choice> {
        self.advice.choice.as_ref()
    }

    /// Residual vibration that 95 % of the uncertainty stays below, and its mean.
    fn uncertain(&self, shaper: &dyn Shaper) -> Option<(f64, f64)> {
        let same = |one: &&choice::Figures| one.shaper.name() == shaper.name();
        let found = self.advice.figures.iter().find(same);
        found.map(|one| (one.worst_95, one.expected))
    }
}

/// The text for an empty recommendation.
const NO_CHOICE: &str = "none; no shaper fits into the delay that is allowed.";

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where the robot is refused, or has no mode at that joint.
pub fn run(args: Args) -> Result<(), CliError> {
    let robot = args.robot_file();
    let reads: Vec<&Path> = robot.into_iter().collect();
    let out = Out::open(&args.out, ("compare", args.force), &reads, [REPORT])?;
    let comparison = compare(&args)?;
    let stage = out.stage()?;
    stage.file(REPORT, page::page(&comparison).render())?;
    stage.put()?;
    let report = args.out.join(REPORT);
    if args.json {
        let mut document = print::document(&comparison);
        document["report"] = json!(report);
        return output::json(&document);
    }
    output::text(&format!(
        "{}\nReport: {}\n{}",
        print::text(&comparison),
        report.display(),
        next_command(&comparison, &args)
    ))
}

/// The next command: the recommended shaper's train; empty without a recommendation.
fn next_command(comparison: &Comparison, args: &Args) -> String {
    let Some(choice) = comparison.choice() else {
        return String::new();
    };
    let shaper = ["shape", "--shaper", choice.figures.shaper.name()].map(String::from);
    let rate = ["--rate".into(), comparison.rate.to_string()];
    let modes: Vec<Mode> = comparison.modes.iter().map(|known| known.mode).collect();
    let words = shaper.into_iter().chain(args.modes.options(&modes));
    next::command(words.chain(rate))
}

fn compare(args: &Args) -> Result<Comparison, CliError> {
    let mut robot = robot(args.robot_file())?;
    let (joint, told) = modes(args, &robot)?;
    robot.control_rate = args.rate.unwrap_or(robot.control_rate);
    let rate = robot.control_rate;
    let mut candidates = candidate::all(&told, 1.0 / rate);
    if let Some(Err(reason)) = candidates.first().map(|candidate| &candidate.design)
        && candidates.iter().all(|candidate| candidate.design.is_err())
    {
        let text = format!("no shaper can be designed at {} Hz: {reason}", number(rate));
        return Err(CliError::input(text));
    }
    let wish = Wish {
        frequency_std: args.frequency_std.unwrap_or(FREQUENCY_STD) / 100.0,
        damping_std: args.damping_std.unwrap_or(DAMPING_STD),
        acceptable: args.acceptable / 100.0,
        max_delay: args.max_delay.unwrap_or(f64::INFINITY),
    };
    let advice = choice::choose(&candidates, &told, wish)?;
    let mut remarks = Vec::new();
    let mut unshaped = None;
    if let Some(joint) = joint {
        unshaped = Some(simulate(&robot, joint, &mut candidates, &mut remarks)?);
    }
    Ok(Comparison {
        machine: match joint {
            Some(joint) => format!("{}, joint {}", robot.name, joint + 1),
            None if told.len() == 1 => "the given mode".into(),
            None => "the given modes".into(),
        },
        modes: told.iter().map(|told| wish.known(told)).collect(),
        rate,
        spread: args.spread / 100.0,
        candidates,
        wish,
        advice,
        unshaped,
        remarks,
    })
}

/// The modes to shape for, and their joint, counted from 0.
fn modes(args: &Args, robot: &Robot) -> Result<(Option<usize>, Vec<ToldMode>), CliError> {
    let mut modes = args.modes.told()?;
    // What the user says of the uncertainty takes the place of what the source tells.
    for told in &mut modes {
        let is_said = [args.frequency_std, args.damping_std].map(|std| std.is_some());
        told.natural_frequency_std = told.natural_frequency_std.filter(|_| !is_said[0]);
        told.damping_ratio_std = told.damping_ratio_std.filter(|_| !is_said[1]);
    }
    if !modes.is_empty() {
        return Ok((None, modes));
    }
    let joint = args.robot.joint_of(robot)?;
    let modes = robot.joints[joint].modes.iter().map(|entry| entry.mode);
    let modes: Vec<ToldMode> = modes.map(ToldMode::from).collect();
    if modes.is_empty() {
        let (number, name) = (joint + 1, &robot.name);
        let text = format!("joint {number} of {name} has no mode in its description");
        return Err(CliError::input(text).with_help("give one: --mode 8.12,0.084"));
    }
    Ok((Some(joint), modes))
}

/// Simulates the robot's move with each shaper at each of [`ERRORS`]; returns the unshaped move.
fn simulate(
    robot: &Robot,
    joint: usize,
    candidates: &mut [Candidate],
    remarks: &mut Vec<String>,
) -> Result<Simulated, CliError> {
    let trial = Trial::new(robot, joint);
    let progress = Progress::new(
        candidates.len() as u64,
        "{pos}/{len} shapers {wide_bar} {eta}",
    )?;
    let unshaped = GridTrain::identity(1.0 / robot.control_rate).map_err(CliError::input)?;
    let unshaped = trial.run(&unshaped, &ERRORS)?;
    for candidate in candidates {
        progress.step();
        let name = candidate.shaper.name();
        let Ok(design) = &mut candidate.design else {
            continue;
        };
        match trial.run(&design.train, &ERRORS) {
            Ok(simulated) => {
                if simulated.speed < 1.0 {
                    remarks.push(shaping::slowed(name, simulated.speed));
                }
                design.simulated = Some(simulated);
            }
            Err(CliError::Input(refusal)) => remarks.push(format!("{name}: {refusal}")),
            Err(other) => return Err(other),
        }
    }
    Ok(unshaped)
}

/// Frequency errors of the curves, from minus to plus the spread.
fn errors(spread: f64) -> impl Iterator<Item = f64> {
    (0..=2 * POINTS).map(move |k| spread * (k as f64 / POINTS as f64 - 1.0))
}

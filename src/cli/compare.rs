//! `quell compare`: what each shaper leaves of a robot's vibration when its frequency is believed
//! wrongly, and which one to take.

mod candidate;
mod choice;
mod page;
mod print;
mod trial;

use super::{CliError, output, shape};
use crate::plant::Robot;
use candidate::{Candidate, Design};
use choice::{Choice, Wish};
use quell_shapers::{GridTrain, Mode, Shaper};
use serde_json::json;
use std::path::PathBuf;
use trial::Trial;

/// Frequency errors of the table.
const ERRORS: [f64; 5] = [-0.25, -0.10, 0.0, 0.10, 0.25];
/// Points of a curve on either side of no error.
const POINTS: usize = 60;

/// Compares all shapers over a spread of frequency errors and recommends one.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  quell compare                              the embedded arm
  quell compare robot.toml --joint 2 --out out
  quell compare --mode 8.12,0.084 --rate 1000 --frequency-std 5 --max-delay 0.1 --json

V is the residual vibration: the amplitude that the shaped command leaves over what the unshaped
one leaves, each at its own end; the columns give it for a machine whose frequency is that much
above (+) or below (-) the believed one. Insensitivity: width of the band with V <= 5 %, over the
frequency. Delay: what the shaper adds to the end of a move. The millimetres are simulated: the
greatest tip deformation after the robot's own move. Writes compare.html into --out.")]
pub struct Args {
    /// The robot's description; the embedded arm where none is given.
    pub robot: Option<PathBuf>,
    /// The joint, counted from 1 [default: the one that the description moves].
    #[arg(long, value_name = "N")]
    pub joint: Option<usize>,
    /// Natural frequency in Hz and damping ratio, instead of the robot's; may be repeated.
    #[arg(long, value_name = "F,XI", value_parser = shape::mode)]
    pub mode: Vec<Mode>,
    /// Commands a second [default: the robot's].
    #[arg(long, value_name = "HZ", value_parser = shape::rate)]
    pub rate: Option<f64>,
    /// How well the frequency is known: one standard deviation, percent.
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0, value_parser = deviation)]
    pub frequency_std: f64,
    /// The longest delay that the recommended shaper may add, s.
    #[arg(long, value_name = "S", value_parser = seconds)]
    pub max_delay: Option<f64>,
    /// How far the curves reach on either side, percent.
    #[arg(long, value_name = "PERCENT", default_value_t = 30.0, value_parser = percent)]
    pub spread: f64,
    /// The folder for the report.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    /// Prints JSON instead of tables.
    #[arg(long)]
    pub json: bool,
}

fn percent(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(percent) if (0.0..100.0).contains(&percent) => Ok(percent),
        _ => Err(format!("{text:?} is not a percentage from 0 to below 100")),
    }
}

/// Two standard deviations below the frequency there must be a frequency left.
fn deviation(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(percent) if (0.0..50.0).contains(&percent) => Ok(percent),
        _ => Err(format!("{text:?} is not a percentage from 0 to below 50")),
    }
}

fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds.is_finite() && seconds >= 0.0 => Ok(seconds),
        _ => Err(format!("{text:?} is not a time of 0 s or more")),
    }
}

/// What is compared, for whom.
struct Comparison {
    machine: String,
    modes: Vec<Mode>,
    rate: f64,
    spread: f64,
    candidates: Vec<Candidate>,
    choice: Option<Choice>,
    /// Simulated tip deformation after the unshaped move at [`ERRORS`], mm.
    unshaped_mm: Option<Vec<f64>>,
}

impl Comparison {
    fn designs(&self) -> impl Iterator<Item = (&'static dyn Shaper, &Design)> {
        self.candidates
            .iter()
            .filter_map(|candidate| Some((candidate.shaper, candidate.design.as_ref().ok()?)))
    }
}

/// What is said where nothing can be recommended.
const NO_CHOICE: &str = "none; no shaper fits into the delay that is allowed.";

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where the robot is refused, or has no mode at that joint.
pub fn run(args: Args) -> Result<(), CliError> {
    let comparison = compare(&args)?;
    let report = args.out.join("compare.html");
    output::folder(&args.out)?;
    output::file(&report, page::page(&comparison).render())?;
    if args.json {
        let mut document = print::document(&comparison);
        document["report"] = json!(report);
        return output::json(&document);
    }
    output::text(&format!(
        "{}\nReport: {}\n",
        print::text(&comparison),
        report.display()
    ))
}

fn compare(args: &Args) -> Result<Comparison, CliError> {
    let mut robot = match &args.robot {
        Some(file) => Robot::from_file(file).map_err(CliError::input)?,
        None => Robot::rx170(),
    };
    let (joint, modes) = modes(args, &robot)?;
    let rate = args.rate.unwrap_or(robot.control_rate);
    let mut candidates = candidate::all(&modes, 1.0 / rate);
    if let Some(Err(reason)) = candidates.first().map(|candidate| &candidate.design)
        && candidates.iter().all(|candidate| candidate.design.is_err())
    {
        let text = format!("no shaper can be designed at {rate} Hz: {reason}");
        return Err(CliError::input(text));
    }
    let mut unshaped_mm = None;
    if let Some(joint) = joint {
        robot.control_rate = rate;
        unshaped_mm = Some(simulate(&robot, joint, &mut candidates)?);
    }
    let machine = match joint {
        Some(joint) => format!("{}, joint {}", robot.name, joint + 1),
        None => "the given mode".into(),
    };
    let wish = Wish {
        frequency_std: args.frequency_std / 100.0,
        max_delay: args.max_delay,
    };
    let choice = choice::choose(&candidates, wish);
    let spread = args.spread / 100.0;
    Ok(Comparison {
        machine,
        modes,
        rate,
        spread,
        candidates,
        choice,
        unshaped_mm,
    })
}

/// The modes that are shaped for, and the joint (counted from 0) whose they are.
fn modes(args: &Args, robot: &Robot) -> Result<(Option<usize>, Vec<Mode>), CliError> {
    if !args.mode.is_empty() {
        return Ok((None, args.mode.clone()));
    }
    let joint = args.joint.unwrap_or(robot.default_move.joint + 1);
    let entry = joint
        .checked_sub(1)
        .and_then(|index| robot.joints.get(index))
        .ok_or_else(|| {
            let count = robot.joints.len();
            CliError::input(format!(
                "--joint {joint}: {} has joints 1 to {count}",
                robot.name
            ))
        })?;
    if entry.modes.is_empty() {
        let text = format!(
            "joint {joint} of {} has no mode in its description",
            robot.name
        );
        return Err(CliError::input(text).with_help("give one: --mode 8.12,0.084"));
    }
    Ok((
        Some(joint - 1),
        entry.modes.iter().map(|mode| mode.mode).collect(),
    ))
}

/// Makes the robot's move with each shaper at each of [`ERRORS`]; gives the unshaped one's mm.
fn simulate(
    robot: &Robot,
    joint: usize,
    candidates: &mut [Candidate],
) -> Result<Vec<f64>, CliError> {
    let trial = Trial::new(robot, joint)?;
    let residual_mm = |train: &GridTrain| -> Result<Vec<f64>, CliError> {
        ERRORS
            .iter()
            .map(|error| Ok(1e3 * trial.residual(train, *error)?))
            .collect()
    };
    for candidate in candidates {
        if let Ok(design) = &mut candidate.design {
            design.residual_mm = Some(residual_mm(&design.train)?);
        }
    }
    let unshaped = GridTrain::identity(1.0 / robot.control_rate).map_err(CliError::input)?;
    residual_mm(&unshaped)
}

/// Frequency errors of the curves, from minus to plus the spread.
fn errors(spread: f64) -> impl Iterator<Item = f64> {
    (0..=2 * POINTS).map(move |k| spread * (k as f64 / POINTS as f64 - 1.0))
}

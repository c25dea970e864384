//! `quell compare`: what each shaper leaves of a robot's vibration when its frequency is believed
//! wrongly, and which one to take.

mod candidate;
mod choice;

use super::{CliError, output, shape};
use crate::plant::Robot;
use candidate::Candidate;
use choice::{Choice, Wish};
use quell_shapers::Mode;
use serde_json::{Value, json};
use std::path::PathBuf;

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
frequency. Delay: what the shaper adds to the end of a move.")]
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
}

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where the robot is refused, or has no mode at that joint.
pub fn run(args: Args) -> Result<(), CliError> {
    let comparison = compare(&args)?;
    if args.json {
        output::json(&document(&comparison))
    } else {
        output::text(&page(&comparison))
    }
}

fn compare(args: &Args) -> Result<Comparison, CliError> {
    let robot = match &args.robot {
        Some(file) => Robot::from_file(file).map_err(CliError::input)?,
        None => Robot::rx170(),
    };
    let (machine, modes) = modes(args, &robot)?;
    let rate = args.rate.unwrap_or(robot.control_rate);
    let candidates = candidate::all(&modes, 1.0 / rate);
    if let Some(Err(reason)) = candidates.first().map(|candidate| &candidate.design)
        && candidates.iter().all(|candidate| candidate.design.is_err())
    {
        let text = format!("no shaper can be designed at {rate} Hz: {reason}");
        return Err(CliError::input(text));
    }
    let wish = Wish {
        frequency_std: args.frequency_std / 100.0,
        max_delay: args.max_delay,
    };
    let choice = choice::choose(&candidates, wish);
    Ok(Comparison {
        machine,
        modes,
        rate,
        spread: args.spread / 100.0,
        candidates,
        choice,
    })
}

/// The modes that are shaped for, and whose they are.
fn modes(args: &Args, robot: &Robot) -> Result<(String, Vec<Mode>), CliError> {
    if !args.mode.is_empty() {
        return Ok(("the given mode".into(), args.mode.clone()));
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
    let modes = entry.modes.iter().map(|mode| mode.mode).collect();
    Ok((format!("{}, joint {joint}", robot.name), modes))
}

fn page(comparison: &Comparison) -> String {
    let modes: Vec<String> = comparison.modes.iter().map(describe).collect();
    let header = [
        "shaper", "delay_s", "I(5 %)", "V -25 %", "-10 %", "0", "+10 %", "+25 %", "gain",
    ];
    let unshaped = ["unshaped", "0", "-", "1", "1", "1", "1", "1", "1"].map(str::to_owned);
    let rows = comparison.candidates.iter().map(row);
    let table = output::table(header, std::iter::once(unshaped).chain(rows));
    let mut refused = String::new();
    for candidate in &comparison.candidates {
        if let Err(reason) = &candidate.design {
            refused.push_str(&format!("{}: {reason}\n", candidate.shaper.name()));
        }
    }
    let advice = match &comparison.choice {
        Some(choice) => format!("Recommended: {}\n", choice.reason),
        None => "Recommended: none; no shaper fits into the delay that is allowed.\n".into(),
    };
    let (machine, rate) = (&comparison.machine, comparison.rate);
    format!(
        "{machine}: {}, {rate} Hz\n\n{table}{refused}\n{advice}",
        modes.join(" and ")
    )
}

fn describe(mode: &Mode) -> String {
    format!(
        "{} Hz with a damping ratio of {}",
        mode.hertz(),
        mode.damping_ratio()
    )
}

fn row(candidate: &Candidate) -> [String; 9] {
    let mut cells = std::array::from_fn(|_| "-".to_owned());
    cells[0] = candidate.shaper.name().into();
    if let Ok(design) = &candidate.design {
        cells[1] = format!("{:.4}", design.train.duration());
        cells[2] = design
            .insensitivity
            .map_or("-".into(), |width| format!("{width:.3}"));
        for (cell, error) in cells[3..].iter_mut().zip(ERRORS) {
            *cell = format!("{:.4}", design.residual(error));
        }
        cells[8] = format!("{:.2}", design.train.gain());
    }
    cells
}

/// Frequency errors of the curves, from minus to plus the spread.
fn errors(spread: f64) -> impl Iterator<Item = f64> {
    (0..=2 * POINTS).map(move |k| spread * (k as f64 / POINTS as f64 - 1.0))
}

fn document(comparison: &Comparison) -> Value {
    let shapers = comparison
        .candidates
        .iter()
        .map(|candidate| match &candidate.design {
            Err(reason) => json!({"shaper": candidate.shaper.name(), "refused": reason}),
            Ok(design) => json!({
                "shaper": candidate.shaper.name(),
                "duration_s": design.train.duration(),
                "insensitivity": design.insensitivity,
                "gain": design.train.gain(),
                "residual_vibration": ERRORS.map(|error| json!({
                    "frequency_error": error,
                    "v": design.residual(error),
                })),
                "curve": {
                    "frequency_error": errors(comparison.spread).collect::<Vec<_>>(),
                    "v": errors(comparison.spread).map(|e| design.residual(e)).collect::<Vec<_>>(),
                },
            }),
        });
    let modes = comparison
        .modes
        .iter()
        .map(|mode| json!({"frequency_hz": mode.hertz(), "damping_ratio": mode.damping_ratio()}));
    json!({
        "machine": comparison.machine,
        "rate_hz": comparison.rate,
        "modes": modes.collect::<Vec<_>>(),
        "shapers": shapers.collect::<Vec<_>>(),
        "recommended": comparison.choice.as_ref().map(|choice| json!({
            "shaper": choice.shaper.name(),
            "reason": choice.reason,
            "worst_v": choice.worst,
        })),
    })
}

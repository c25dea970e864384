//! `quell shape`: a shaper's train for given modes, and a shaped copy of a command file.

mod command_file;

use super::mode_args::ModeArgs;
use super::out::Force;
use super::{CliError, choices, next, output, shaping, values};
use crate::identification::ToldMode;
use crate::page::{columns, number};
use crate::recording::plain;
use quell_shapers::{
    Band, GridTrain, ImpulseTrain, Mode, Optimal, Shaper, UncertainMode, design_for_all,
    insensitivity, residual_vibration,
};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Residual vibration that defines the insensitivity.
const TOLERANCE: f64 = 0.05;

/// Designs a shaper for one mode or several, and shapes a command file with it.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell shape --shaper zvd --mode 8.12,0.084 --rate 250
  quell shape --shaper zv --mode 8.12,0.084 --mode 21,0.02 --rate 1000 --json
  quell shape --shaper zvd --model out/model.toml --rate 250
  quell shape --shaper zvd --recording decay.csv --rate 250
  quell shape --shaper optimal --mode 8.12,0.084 --frequency-std 3 --damping-std 0.01 --rate 250
  quell shape --shaper zvd --mode 8.12,0.084 --rate 250 command.csv --column joint_1_rad --out out

V is the residual vibration: the amplitude that the shaped command leaves over what the unshaped \
one leaves, each at its own end. The insensitivity is the width of the band of frequencies, over \
the design frequency, in which V stays at or below 5 %. Where a file has columns of several joints, \
give the mode of each: all columns run the same train, and the joints keep their path.")]
pub struct Args {
    /// The shaper.
    #[arg(long, value_parser = choices::shapers())]
    pub shaper: &'static dyn Shaper,
    /// The modes.
    #[command(flatten)]
    pub modes: ModeArgs,
    /// Standard deviation of the frequency, in percent of it, that `optimal` is solved for, with --mode once
    /// [default: what --model or --recording tells; else it may be off by 10 % and the damping ratio by half].
    #[arg(long, value_name = "PERCENT", value_parser = values::positive,
          allow_negative_numbers = true)]
    pub frequency_std: Option<f64>,
    /// Standard deviation of the damping ratio, beside --frequency-std.
    #[arg(long, value_name = "STD", value_parser = values::positive, requires = "frequency_std",
          allow_negative_numbers = true)]
    pub damping_std: Option<f64>,
    /// Samples of the command a second.
    #[arg(long, value_name = "HZ", value_parser = values::positive,
          allow_negative_numbers = true)]
    pub rate: f64,
    /// A command file to shape, .csv or .csv.gz; its name with `_shaped` is written to --out.
    #[arg(requires = "column")]
    pub file: Option<PathBuf>,
    /// The column to shape; several may be named.
    #[arg(long, value_name = "NAME", requires = "file")]
    pub column: Vec<String>,
    /// The column with seconds, checked against --rate [default: time_s, t_s, time or t].
    #[arg(long, value_name = "NAME", requires = "file")]
    pub time: Option<String>,
    /// The folder for the shaped file.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    force: Force,
    /// Prints JSON instead of tables.
    #[arg(long)]
    pub json: bool,
}

/// The designed train.
struct Design {
    shaper: &'static dyn Shaper,
    modes: Vec<Mode>,
    train: ImpulseTrain,
    grid: GridTrain,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where the shaper cannot be designed or the file is refused.
pub fn run(args: Args) -> Result<(), CliError> {
    let design = design(&args)?;
    let file = match &args.file {
        Some(file) => Some(command_file::shape(file, &args, &design.grid)?),
        None => None,
    };
    if args.json {
        return output::json(&document(&design, file.as_ref())?);
    }
    let mut page = page(&design)?;
    if let Some(file) = file {
        page.push_str(&format!(
            "\nWrote {}: {} rows, {} more than the command.\n",
            file.path.display(),
            file.rows,
            file.appended
        ));
    }
    output::text(&format!("{page}\n{}", next_command(&design, &args)))
}

/// The next command: to shape a command file, or for a shaped file, to inspect the recorded response of the
/// robot.
fn next_command(design: &Design, args: &Args) -> String {
    if args.file.is_some() {
        let next = next::command(["inspect", "RECORDING.csv"]);
        return format!("Run it on the robot and record it. {next}");
    }
    let shaper = ["shape", "--shaper", design.shaper.name()]
        .map(String::from)
        .into_iter();
    let words = shaper.chain(args.modes.options(&design.modes));
    let rate = ["--rate".into(), args.rate.to_string()];
    let file = ["COMMAND.csv", "--column", "NAME"].map(String::from);
    next::command(words.chain(rate).chain(file))
}

fn design(args: &Args) -> Result<Design, CliError> {
    let told = args.modes.told()?;
    if told.is_empty() {
        let error = CliError::input("the modes to shape for are not said");
        return Err(
            error.with_help("give --mode 8.12,0.084, --model FILE or --recording RECORDING")
        );
    }
    let known = known(args, &told)?;
    let modes = told.iter().map(|told| told.mode).collect();
    let train = design_for_all(args.shaper, &known).map_err(CliError::input)?;
    check_length(&train, args.rate)?;
    let grid = shaping::train(args.shaper, known, 1.0 / args.rate)
        .map_err(|error| CliError::input(format!("at {} Hz: {error}", plain(args.rate))))?;
    Ok(Design {
        shaper: args.shaper,
        modes,
        train,
        grid,
    })
}

/// Refuses a rate at which no filter holds the train.
fn check_length(train: &ImpulseTrain, rate: f64) -> Result<(), CliError> {
    let (duration, most) = (train.duration(), shaping::LONGEST_TRAIN as f64);
    if duration * rate <= most {
        return Ok(());
    }
    let [rate, duration, most] = [rate, duration, most].map(plain);
    Err(CliError::input(format!(
        "--rate {rate}: a train of {duration} s has more than {most} samples then"
    )))
}

/// The modes with their given uncertainty, or what their source tells of it.
fn known(args: &Args, told: &[ToldMode]) -> Result<Vec<UncertainMode>, CliError> {
    let Some(percent) = args.frequency_std else {
        return Ok(told.iter().map(ToldMode::or_believed).collect());
    };
    let &[ToldMode { mode, .. }] = told else {
        return Err(CliError::input(
            "--frequency-std is of one mode, and there are several",
        ));
    };
    if args.shaper.name() != Optimal::TYPICAL.name() {
        let name = args.shaper.name();
        return Err(CliError::input(format!(
            "--frequency-std is what --shaper optimal is solved for, not {name}; `quell compare` tells \
             what the others leave"
        )));
    }
    Ok(vec![UncertainMode {
        mode,
        natural_frequency_std: percent / 100.0 * mode.natural_frequency(),
        damping_ratio_std: args.damping_std.unwrap_or(0.0),
    }])
}

impl Design {
    /// Residual vibration of the taps at one of the modes, and the band around it.
    fn at(&self, mode: Mode) -> Result<(f64, Option<Band>), CliError> {
        let taps = self.grid.to_impulses();
        let (frequency, damping_ratio) = (mode.natural_frequency(), mode.damping_ratio());
        let residual = residual_vibration(&taps, frequency, damping_ratio);
        let band = insensitivity(&taps, damping_ratio, frequency, TOLERANCE);
        Ok((residual, band.map_err(CliError::input)?))
    }
}

fn page(design: &Design) -> Result<String, CliError> {
    let impulses = design.train.impulses().iter();
    let impulses = impulses.map(|impulse| {
        [
            format!("{:.6}", impulse.time),
            format!("{:.6}", impulse.amplitude),
        ]
    });
    let taps = design.grid.taps().iter().map(|tap| {
        let time = f64::from(tap.delay) * design.grid.sample_time();
        [
            tap.delay.to_string(),
            format!("{time:.6}"),
            format!("{:.6}", tap.amplitude),
        ]
    });
    let gain = design.grid.gain();
    let peak = match design.shaper.is_convex() {
        true => String::new(),
        false => format!(
            "Its amplitudes have both signs: peak velocity and acceleration can grow to {gain:.2} \
             times the command's.\n"
        ),
    };
    Ok(format!(
        "{title}: {summary}\n\n{impulses}\n{taps}\n{modes}\n\
         Delay {:.6} s, on the grid {:.6} s. Sum of |amplitude| {gain:.4}.\n{peak}",
        design.train.duration(),
        design.grid.duration(),
        title = design.shaper.title(),
        summary = design.shaper.summary(),
        impulses = columns(["impulse_s", "amplitude"], impulses),
        taps = columns(["tap", "time_s", "amplitude"], taps),
        modes = modes(design)?,
    ))
}

/// The table of the residual vibration of each mode.
fn modes(design: &Design) -> Result<String, CliError> {
    let mut rows = Vec::new();
    for &mode in &design.modes {
        let (residual, band) = design.at(mode)?;
        let width = band.map_or("-".into(), |band| format!("{:.4}", band.width()));
        let edges = |band: Band| [band.from * mode.hertz(), band.to * mode.hertz()];
        let range = band
            .map(edges)
            .map_or("-".into(), |[from, to]| format!("{from:.3} to {to:.3}"));
        let name = format!(
            "{} Hz, {}",
            number(mode.hertz()),
            number(mode.damping_ratio())
        );
        rows.push([name, format!("{residual:.1e}"), width, range]);
    }
    Ok(columns(
        ["mode", "V of the taps", "insensitivity", "band_hz"],
        rows,
    ))
}

fn document(design: &Design, file: Option<&command_file::ShapedFile>) -> Result<Value, CliError> {
    let impulses = design.train.impulses().iter();
    let taps = design.grid.taps().iter();
    let mut modes = Vec::new();
    for &mode in &design.modes {
        let (residual, band) = design.at(mode)?;
        modes.push(json!({
            "frequency_hz": mode.hertz(),
            "damping_ratio": mode.damping_ratio(),
            "residual_vibration": residual,
            "insensitivity": band.map(|band| band.width()),
            "band_hz": band.map(|band| [band.from * mode.hertz(), band.to * mode.hertz()]),
        }));
    }
    Ok(json!({
        "shaper": design.shaper.name(),
        "rate_hz": 1.0 / design.grid.sample_time(),
        "modes": modes,
        "impulses": impulses
            .map(|impulse| json!({"time_s": impulse.time, "amplitude": impulse.amplitude}))
            .collect::<Vec<_>>(),
        "taps": taps
            .map(|tap| json!({
                "delay_ticks": tap.delay,
                "time_s": f64::from(tap.delay) * design.grid.sample_time(),
                "amplitude": tap.amplitude,
            }))
            .collect::<Vec<_>>(),
        "duration_s": design.train.duration(),
        "duration_on_grid_s": design.grid.duration(),
        "gain": design.grid.gain(),
        "file": file.map(|file| json!({
            "path": file.path,
            "rows": file.rows,
            "appended_rows": file.appended,
        })),
    }))
}

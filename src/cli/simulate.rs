//! `quell simulate`: the simulation of moves, or of a recorded command, with a robot's joint, written as a
//! recording.

mod document;
mod limits;
mod motion;
mod planned;
mod predicted;
mod recorded;
mod setup;
mod slopes;
mod trace;

use std::path::{Path, PathBuf};

use quell_shapers::{Mode, Shaper};

use super::out::{Force, Out, recording_files};
use super::robot_args::{RobotArgs, SimulationArgs};
use super::{CliError, choices, output, values};
use crate::model::believed;
use crate::plant::ArmSimulation;
use setup::Setup;
use trace::Trace;

/// Simulates moves, or a recorded command, and writes what the sensors see as a recording.
///
/// Without arguments: the embedded arm and its own move, 30 degrees, unshaped. With a model and a
/// recording: what the model predicts of it.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell simulate
  quell simulate --target 30 --target 0 --dwell 2 --payload 10 --out data
  quell simulate --robot robot.toml --joint 2 --shaper zvd --belief 11,0.05 --json
  quell simulate --residual 5 --belief 8.12,0.084
  quell simulate --command data --noise 5
  quell simulate --command command.csv --column joint_1_deg --unit deg --rate 250
  quell simulate model.toml arm7 --out prediction.csv

The folder of --out gets recording.toml with the command, the encoder and the tracker, each on its \
own clock, and model.toml with what is believed of the joint; `quell identify` and `quell inspect` \
read them. Residual: peak of the true deformation at the tip from where the motor side has come to \
rest, to one encoder step, until the next move begins.")]
pub struct Args {
    /// A model to predict a recording with, instead of a robot's moves.
    #[arg(value_name = "MODEL", requires = "recording",
          conflicts_with_all = ["target", "shaper", "command", "pose", "mode", "belief", "dwell", "residual", "deviation"])]
    pub model: Option<PathBuf>,
    /// The recording to predict: its manifest, the folder of a recording.toml, or an MCAP file.
    #[arg(value_name = "RECORDING")]
    pub recording: Option<PathBuf>,
    #[command(flatten)]
    robot: RobotArgs,
    /// Where to move, deg from where the joint stands at the start; may be repeated [default: as
    /// the description says, 30].
    #[arg(
        long,
        visible_alias = "target-deg",
        value_name = "DEG",
        value_parser = values::angle,
        allow_negative_numbers = true
    )]
    pub target: Vec<f64>,
    /// Rest after each move, s [default: 12 periods of the slowest mode, at least 1 s].
    #[arg(long, value_name = "S", value_parser = values::not_negative,
           allow_negative_numbers = true)]
    pub dwell: Option<f64>,
    /// The shaper of the moves [default: none].
    #[arg(long, value_parser = choices::shapers())]
    pub shaper: Option<&'static dyn Shaper>,
    /// Moves as fast as they may be when they leave so much vibration of the believed modes, percent of the unshaped.
    #[arg(long, value_name = "PERCENT", value_parser = values::residual, allow_negative_numbers = true,
          conflicts_with_all = ["shaper", "command"])]
    pub residual: Option<f64>,
    /// Moves as fast as they may be when the tip vibrates at their ends by so much, mm.
    #[arg(long, value_name = "MM", value_parser = values::limit, allow_negative_numbers = true,
          conflicts_with_all = ["shaper", "command"])]
    pub deviation: Option<f64>,
    /// The believed mode, natural frequency in Hz and damping ratio; several are shaped for at once
    /// [default: the joint's own without payload, in its home pose].
    #[arg(long, value_name = "F,XI", value_parser = values::mode, allow_hyphen_values = true)]
    pub belief: Vec<Mode>,
    /// A recorded command instead of moves: a recording with a command_position, or a CSV file.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["target", "shaper"])]
    pub command: Option<PathBuf>,
    /// The column of the CSV file.
    #[arg(long, value_name = "NAME", requires = "command")]
    pub column: Option<String>,
    /// The unit of the column.
    #[arg(long, value_name = "UNIT", default_value = "rad", requires = "column")]
    pub unit: String,
    /// The column with seconds [default: time_s, t_s, time or t].
    #[arg(long, value_name = "NAME", requires = "column")]
    pub time: Option<String>,
    /// Rows a second of the CSV file, checked against the column with seconds where there is one.
    #[arg(long, value_name = "HZ", value_parser = values::positive,
          allow_negative_numbers = true, requires = "column")]
    pub rate: Option<f64>,
    /// Where the joints stand at the start, deg, or m for joints that slide [default: home].
    #[arg(
        long,
        value_name = "DEG,...",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub pose: Vec<f64>,
    /// The joint's first mode in its home pose without payload, instead of the description's.
    #[arg(long, value_name = "F,XI", value_parser = values::mode, allow_hyphen_values = true)]
    pub mode: Option<Mode>,
    #[command(flatten)]
    simulation: SimulationArgs,
    /// The folder for the recording, or the file for the prediction.
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
/// [`CliError::Input`] where the robot, the move or the command is refused.
pub fn run(args: Args) -> Result<(), CliError> {
    if let (Some(model), Some(recording)) = (&args.model, &args.recording) {
        return predicted::run(model, recording, &args);
    }
    let mut setup = Setup::from(&args)?;
    if let Some(file) = &args.command {
        apart(file, &args.out)?;
    }
    let out = folder(&args, &setup)?;
    let mut motion = match &args.command {
        Some(file) => recorded::read(file, &args, &setup)?,
        None => planned::plan(&args, &setup)?,
    };
    setup.pose[setup.joint] = motion.knots[0].position;
    setup.options.pose = Some(setup.pose.clone());
    let mut arm =
        ArmSimulation::new(&setup.robot, setup.joint, &setup.options).map_err(CliError::input)?;
    motion.remarks.extend(limits::exceeded(&motion, &setup));
    let trace = Trace::run(&mut arm, &motion);
    let files = write((&args, &out), &setup, &arm, &trace)?;
    let run = document::Run {
        args: &args,
        setup: &setup,
        arm: &arm,
        motion: &motion,
        trace: &trace,
        files: &files,
    };
    if args.json {
        return output::json(&document::document(&run));
    }
    output::text(&document::text(&run))
}

/// Refuses to overwrite the recording that is read.
fn apart(command: &Path, out: &Path) -> Result<(), CliError> {
    let folder = match command.is_dir() {
        true => Some(command),
        false => command.parent(),
    };
    let real = |path: &Path| match path.as_os_str().is_empty() {
        true => Path::new(".").canonicalize().ok(),
        false => path.canonicalize().ok(),
    };
    match (folder.and_then(real), real(out)) {
        (Some(read), Some(written)) if read == written => {
            let text = format!("--out {}: the command is in that folder", out.display());
            Err(CliError::input(text).with_help("give another folder, --out DIR"))
        }
        _ => Ok(()),
    }
}

/// The folder, if recording and model may be written there.
fn folder(args: &Args, setup: &Setup) -> Result<Out, CliError> {
    let reads = [args.command.as_deref(), args.robot.robot.as_deref()];
    let reads: Vec<&Path> = reads.into_iter().flatten().collect();
    let names = recording_files("").chain(setup.belief.first().map(|_| MODEL.into()));
    Out::open(&args.out, ("simulate", args.force), &reads, names)
}

/// File name of the joint's nominal model.
const MODEL: &str = "model.toml";

/// Writes recording and model; returns the files.
fn write(
    (args, out): (&Args, &Out),
    setup: &Setup,
    arm: &ArmSimulation,
    trace: &Trace,
) -> Result<Vec<PathBuf>, CliError> {
    let stage = out.stage()?;
    trace
        .recording
        .write(stage.path(), true)
        .map_err(CliError::failure)?;
    let mut files = vec![args.out.join(crate::recording::MANIFEST)];
    if let Some(&belief) = setup.belief.first() {
        stage.file(MODEL, believed::flexible_joint(belief, Some(arm.arc())))?;
        files.push(args.out.join(MODEL));
    }
    stage.put()?;
    Ok(files)
}

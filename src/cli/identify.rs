//! `quell identify`: every estimator on a recording, with the off-line references for comparison.

mod alone;
mod alone_page;
mod axis;
mod document;
mod identified;
mod model;
mod page;
mod printer;
mod refused;
mod registrations;
mod remarks;
mod several;
mod sole;
mod words;

pub use alone::{can, needs_model};
pub use identified::Identified;
pub use sole::role as sole_drive;

use super::out::{Force, Out};
use super::{CliError, choices, output};
use crate::estimators::ESTIMATORS;
use crate::identification::stop::{Stop, never};
use crate::identification::{
    Identification, IdentificationError, ModelError, NominalModel, Prior, Run, Series,
    identify_until, prepare,
};
use crate::page::{columns, decimals_beside, fixed};
use crate::recording::{Recording, Role};
use crate::signal::TipRegistration;
use registrations::Registered;
use std::path::{Path, PathBuf};

/// Identifies the vibratory mode of a recording, on-line by every estimator and off-line.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  quell identify arm7/recording.toml
  quell identify arm7 --model model.toml --out out   (the folder of a recording.toml)
  quell identify arm7 --json
  quell identify decay.csv                           (an accelerometer alone)
  quell identify raw_data_x_*.csv raw_data_y_*.csv   (a printer: prints the lines for its firmware)

What vibrates alone, an accelerometer or any channel of the link, gives its modes from a free decay, a tap, a \
sweep or the machine at work, and the shaper for them; where a channel tells when the motor side rests, from the \
decays in its rests. With motor_position (or motor_velocity, or command_position) and one of deformation, \
link_position, tip_position, the motor side's motion is the known input. A tip sensor \
in a frame of its own needs a model with the lever arm:
  kind = \"flexible_joint\"
  natural_frequency_hz = 8.2
  damping_ratio = 0.06
  lever_arm_m = 1.8
  tip_height_m = 0.9
Its frame is then learned from the recording in the way of --registration, and what the other way would \
make of it is told beside.

Estimators that know the motor side's motion see the whole recording, of more than 1e5 samples the \
1e5 in a row whose deformation varies most, if the motion explains the deformation; the others, and \
all where it does not, see the strongest free decay.")]
pub struct Args {
    /// The manifest (recording.toml), its folder, an MCAP file, or a CSV or Parquet file that says what its columns
    /// are; several of what vibrates alone.
    #[arg(required = true)]
    pub recording: Vec<PathBuf>,
    /// The model of the joint, as it is believed.
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// How the frame of a tip sensor is learned.
    #[arg(long, default_value = "arc", value_parser = choices::registrations())]
    pub registration: TipRegistration,
    /// Prints JSON instead of tables.
    #[arg(long)]
    pub json: bool,
    /// The folder for the report, identify.html, and for model.toml.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    force: Force,
}

/// Name of the report.
const REPORT: &str = "identify.html";
/// Name of the model beside it.
pub const MODEL: &str = "model.toml";
/// Name of the model if the folder has a model.toml that this verb did not write.
const IDENTIFIED: &str = "identified.toml";

/// All findings for a joint with a known input.
struct Findings {
    recording: String,
    series: Series,
    found: Identification,
    /// The results of each way to register a tip sensor.
    registered: Vec<Registered>,
}

impl From<ModelError> for CliError {
    fn from(error: ModelError) -> Self {
        Self::input(error)
    }
}

impl From<IdentificationError> for CliError {
    fn from(error: IdentificationError) -> Self {
        Self::input(error)
    }
}

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where recording or model is refused, or nothing vibrates.
pub fn run(args: Args) -> Result<(), CliError> {
    let reads: Vec<&Path> = args.model.as_deref().into_iter().collect();
    let open = |models: &[String]| {
        let models = models.iter().map(String::as_str);
        let names = std::iter::once(REPORT).chain(models);
        Out::open(&args.out, ("identify", args.force), &reads, names)
    };
    let mut files = model::names(&args.recording);
    // A model.toml of another verb, or the one that is read, is not replaced.
    let out = match open(&files) {
        Err(_) if files == [MODEL] => {
            files = vec![IDENTIFIED.into()];
            open(&files)?
        }
        out => out?,
    };
    let mut recordings = Vec::new();
    for path in &args.recording {
        recordings.push((path.clone(), Recording::from_path(path)?));
    }
    let model = args.model.as_ref().map(NominalModel::from_path);
    let model = model.transpose()?;
    let identified = Identified::of(recordings, model.as_ref(), args.registration, &never)?;
    let stage = out.stage()?;
    stage.file(REPORT, identified.page().render())?;
    let mut written = Vec::new();
    for (file, model) in files.iter().zip(identified.models()) {
        if let Some(text) = model {
            stage.file(file, text)?;
            written.push(args.out.join(file));
        }
    }
    stage.put()?;
    if args.json {
        return output::json(&identified.document());
    }
    output::text(&format!(
        "{}\nReport: {}\n{}",
        identified.text(),
        args.out.join(REPORT).display(),
        ends(&written)
    ))
}

/// The last lines: the models where there are several, and the next command with the first.
fn ends(models: &[PathBuf]) -> String {
    let next = models.first().map(|first| model::next(first));
    let names: Vec<String> = models
        .iter()
        .map(|file| file.display().to_string())
        .collect();
    let all = match names.len() {
        0 | 1 => String::new(),
        _ => format!("Models: {}\n", names.join(", ")),
    };
    all + &next.unwrap_or_default()
}

impl Findings {
    /// The findings for a recording with a known input.
    fn of(
        recording: Recording,
        model: Option<&NominalModel>,
        registration: TipRegistration,
        stop: Stop,
    ) -> Result<Self, IdentificationError> {
        let name = recording.name.clone();
        let tip = recording.channel(Role::TipPosition);
        let again = tip.is_some().then(|| recording.clone());
        let series = prepare(recording, model, registration)?;
        let found = identify_until(&series.samples, prior(model, &series), stop);
        let found = found.map_err(|error| error.of_servo(series.includes_servo()))?;
        let registered = again.map_or_else(Vec::new, |recording| {
            registrations::all(&recording, model, registration, (&series, &found))
        });
        Ok(Self {
            recording: name,
            series,
            found,
            registered,
        })
    }
}

fn prior(model: Option<&NominalModel>, series: &Series) -> Prior {
    Prior {
        belief: model.map(|model| model.mode),
        scale_is_open: series.scale_is_open,
        rounding: series.rounding,
    }
}

/// The text that the verb prints.
fn tables(findings: &Findings) -> String {
    let remarks: String = words::remarks(findings)
        .iter()
        .map(|remark| format!("- {remark}\n"))
        .collect();
    let (on_line, off_line) = (
        on_line(&findings.found),
        off_line(findings.found.reference()),
    );
    let registered = registrations::text(&findings.registered);
    let best = findings.found.recommended();
    let best = best.map_or(String::new(), |best| {
        format!("\nRecommended: {}\n", words::recommended(findings, &best))
    });
    format!(
        "{}\n\n{on_line}\n{off_line}\n{registered}{remarks}{best}",
        findings.recording
    )
}

/// The estimates of every estimator, over its reported run.
fn on_line(found: &Identification) -> String {
    let best = found.recommended();
    let figure = |value: Option<f64>, digits: usize| {
        value
            .filter(|v| v.is_finite())
            .map_or("-".into(), |v| fixed(v, digits))
    };
    let deviation =
        |std: Option<f64>, digits: usize| figure(std, decimals_beside(std.unwrap_or(0.0), digits));
    let rows = ESTIMATORS.iter().enumerate().map(|(index, line)| {
        let run = found.quoted(index);
        let result = run.and_then(|run| run.estimator(line.name));
        let estimate = result.and_then(|result| result.estimate);
        let std = estimate.map(|e| found.deviations(&e, line.states_error));
        let tau = core::f64::consts::TAU;
        [
            line.name.to_string(),
            figure(estimate.map(|e| e.mode.hertz()), 3),
            deviation(std.map(|std| std[0] / tau), 3),
            figure(estimate.map(|e| e.mode.damping_ratio()), 4),
            deviation(std.map(|std| std[1]), 4),
            figure(estimate.map(|e| e.gain), 4),
            figure(result.and_then(|r| r.converged_at), 3),
            figure(result.and_then(|r| r.periods), 2),
            run.map_or("-".into(), words::shown),
            match best.is_some_and(|best| best.method == line.name) {
                true => "recommended".into(),
                false => String::new(),
            },
        ]
    });
    let heads = [
        "on-line",
        "f_hz",
        "std",
        "xi",
        "std",
        "gain",
        "converged_s",
        "periods",
        "over",
        "",
    ];
    columns(heads, rows)
}

/// The estimates of the references for a run.
fn off_line(run: &Run) -> String {
    let rows = run.off_line.iter().map(|line| {
        [
            line.method.to_string(),
            fixed(line.mode.hertz(), 3),
            fixed(line.mode.damping_ratio(), 4),
            words::used(run),
        ]
    });
    columns(["off-line", "f_hz", "xi", "over"], rows)
}

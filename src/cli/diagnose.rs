//! `quell diagnose`: finds the physics that a model lacks, from recordings.

mod batch;
mod help;
mod robot;

pub use help::long_help;

use super::out::{Force, Out};
use super::progress::Progress;
use super::{CliError, next, output, values};
use crate::batch::Shard;
use crate::diagnosis::{Diagnosis, Options, Outcome, Stop, Verdict, diagnose};
use crate::effects::Catalogue;
use crate::model::Model;
use crate::recording::Recording;
use crate::report::{Case, page, text};
use help::help;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// The written files; the last one is the model with the physics.
const FILES: [&str; 3] = ["report.html", "diagnosis.json", "model.toml"];
/// Gravity of a robot that stands upright: the standard acceleration of free fall, m/s^2.
const EARTH: [f64; 3] = [0.0, 0.0, -9.80665];
/// Steps of the progress bar.
const STEPS: f64 = 1000.0;

/// Says what physics a model lacks, from recordings: names it, puts it into the model, and shows
/// the fit before and after.
#[derive(Debug, clap::Args)]
#[command(after_help = help(), after_long_help = long_help(Catalogue::default()))]
pub struct Args {
    /// The model that is believed in. With --robot also a folder with JOINT.toml for some of the joints.
    #[arg(long, value_name = "FILE", required_unless_present = "robot")]
    pub model: Option<PathBuf>,
    /// The robot's description (URDF): diagnoses every joint of the recordings, each with the forces and the inertia that
    /// it sees along the motion of all. Without --model a joint is a rigid axis whose torque was measured.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["batch", "queue"])]
    pub robot: Option<PathBuf>,
    /// Gravity in the frame of the robot's base, m/s^2 [default: 0,0,-9.80665].
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', allow_hyphen_values = true,
          requires = "robot", value_parser = super::values::finite)]
    pub gravity: Vec<f64>,
    /// The manifests, the folders that hold a recording.toml, or MCAP files.
    #[arg(required = true, value_name = "RECORDING")]
    pub recordings: Vec<PathBuf>,
    /// A recording to judge by, which nothing is fitted to; may be repeated.
    #[arg(long, value_name = "RECORDING")]
    pub held_out: Vec<PathBuf>,
    /// The folder for report, diagnosis and model.
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub out: PathBuf,
    #[command(flatten)]
    force: Force,
    /// Prints diagnosis.json instead of text.
    #[arg(long)]
    pub json: bool,
    /// Diagnoses each recording by itself, as many at once as there are cores.
    #[arg(long, conflicts_with = "held_out")]
    pub batch: bool,
    /// Puts the recordings behind the word `submit` into the queue at this address; needs the feature `nats`.
    #[arg(long, hide = cfg!(not(feature = "nats")), value_name = "URL", conflicts_with_all = ["batch", "held_out", "jobs", "out"])]
    pub queue: Option<String>,
    /// Only the I-th of N shares of a batch, as in an array of jobs.
    #[arg(long, value_name = "I/N")]
    pub shard: Option<Shard>,
    /// Threads to work with, or recordings at once [default: one a core].
    #[arg(long, value_name = "N", value_parser = values::count::<u16>)]
    pub jobs: Option<u16>,
    /// Ends the search for further effects after this time, and tells the best explanation so far, marked as such.
    #[arg(long, value_name = "SECONDS", conflicts_with_all = ["batch", "queue"], value_parser = seconds)]
    pub time_limit: Option<Duration>,
    /// Seed of the confidence intervals' bootstrap.
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
}

impl Args {
    /// The model's file, which may be absent only with --robot.
    fn model(&self) -> &Path {
        self.model.as_deref().unwrap_or(Path::new(""))
    }

    fn options(&self) -> Options {
        Options {
            seed: self.seed,
            enough: self.time_limit.map_or_else(Stop::default, after),
            ..Options::default()
        }
    }
}

/// A time above 0.
fn seconds(text: &str) -> Result<Duration, String> {
    let number: f64 = text
        .parse()
        .map_err(|_| format!("\"{text}\" is no number of seconds"))?;
    match number > 0.0 {
        true => Duration::try_from_secs_f64(number).map_err(|error| error.to_string()),
        false => Err(format!("{text} s leave no time to look")),
    }
}

/// A stop that asks for the end once this time has passed.
fn after(limit: Duration) -> Stop {
    let start = Instant::now();
    Stop::when(move || start.elapsed() > limit)
}

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where model or recordings are refused.
pub fn run(args: Args) -> Result<(), CliError> {
    if args.force.force && (args.batch || args.queue.is_some()) {
        let error = CliError::input("--force: a batch replaces nothing");
        return Err(error.with_help("remove the folder of a result to have it again"));
    }
    if let Some(queue) = &args.queue {
        return batch::submit(queue, &args);
    }
    if args.batch {
        return batch::run(&args);
    }
    if args.shard.is_some() {
        let error = CliError::input("--shard: there is no batch of which this could be a share");
        return Err(error.with_help("add --batch, or --queue URL submit"));
    }
    if let Some(description) = &args.robot {
        return robot::run(description, &args);
    }
    let file = args.model();
    let out = Out::open(&args.out, ("diagnose", args.force), &[file], FILES)?;
    let model = Model::from_path(file).map_err(CliError::input)?;
    let read = |paths: &[PathBuf]| -> Result<Vec<Recording>, CliError> {
        let all = paths.iter().map(|path| Ok(Recording::from_path(path)?));
        all.collect()
    };
    let (train, held_out) = (read(&args.recordings)?, read(&args.held_out)?);
    let options = args.options();
    let bar = Progress::new(STEPS as u64, "{bar:30} {percent:>3} % {msg}")?;
    let progress = |done: f64, what: &str| bar.set((done.clamp(0.0, 1.0) * STEPS) as u64, what);
    let work = || diagnose(&model, &train, &held_out, &options, &progress);
    let outcome = on_threads(args.jobs, work);
    drop(bar);
    let outcome = outcome?.map_err(CliError::input)?;
    let recordings = train.iter().chain(&held_out);
    let names: Vec<_> = recordings.map(|one| one.name.clone()).collect();
    let files = write(&args, &out, &outcome, &names)?;
    if args.json {
        output::json(&outcome.diagnosis)?;
        return told(&outcome.diagnosis);
    }
    let case = Case::new(&outcome.diagnosis, &outcome.traces);
    let next = next_command(&args, &outcome.diagnosis);
    let next = next.map_or_else(String::new, |next| format!("\n{next}"));
    output::text(&format!("{}{next}", text(&case, &files)))?;
    told(&outcome.diagnosis)
}

/// The next command. It diagnoses again with the recording that the diagnosis proposes, if it proposes one. Where
/// no motion would decide there is none: the text says what to change. Otherwise it scores the written model on
/// another recording.
fn next_command(args: &Args, diagnosis: &Diagnosis) -> Option<String> {
    let Some(proposed) = &diagnosis.next_move else {
        let model = args.out.join(FILES[2]);
        return Some(next::command([
            "score".as_ref(),
            model.as_path(),
            "ANOTHER_RECORDING".as_ref(),
        ]));
    };
    if proposed.moves.is_empty() {
        return None;
    }
    let words = [Path::new("diagnose"), Path::new("--model"), args.model()];
    let recordings = args.recordings.iter().map(PathBuf::as_path);
    let words = words.into_iter().chain(recordings);
    Some(next::then(words.chain([Path::new("NEW_RECORDING")])))
}

/// Refuses a recording without a statement on the model: a script must not take it for a healthy model.
fn told(diagnosis: &Diagnosis) -> Result<(), CliError> {
    match diagnosis.verdict {
        Verdict::NotExcited => {
            let text = format!(
                "{}: the recording says nothing of the model",
                diagnosis.verdict.name()
            );
            Err(CliError::input(text))
        }
        _ => Ok(()),
    }
}

/// Runs `work` with this number of threads.
fn on_threads<T: Send>(jobs: Option<u16>, work: impl FnOnce() -> T + Send) -> Result<T, CliError> {
    let Some(jobs) = jobs else {
        return Ok(work());
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(usize::from(jobs));
    Ok(pool.build().map_err(CliError::failure)?.install(work))
}

/// Writes the three files, and returns them, the report first.
fn write(
    args: &Args,
    out: &Out,
    outcome: &Outcome,
    names: &[String],
) -> Result<Vec<PathBuf>, CliError> {
    let model = args.model().display().to_string();
    let page = page(&outcome.diagnosis, &outcome.traces, &model, names).footnote(format!(
        "quell diagnose --model {model}, seed {}",
        args.seed
    ));
    let mut document =
        serde_json::to_string_pretty(&outcome.diagnosis).map_err(CliError::failure)?;
    document.push('\n');
    let stage = out.stage()?;
    let contents = [page.render(), document, outcome.to_toml()];
    for (name, content) in FILES.iter().zip(contents) {
        stage.file(name, content)?;
    }
    stage.put()?;
    Ok(FILES.map(|name| args.out.join(name)).into())
}

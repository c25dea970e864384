//! `quell prove`: the diagnosis on recordings with a hidden effect.

use super::out::{Force, Out, Stage};
use super::progress::Progress;
use super::{CliError, choices, next, output, values};
use crate::diagnosis::{Diagnosis, FittedParameter, Options, diagnose, score};
use crate::model::Model;
use crate::proof::{
    Claim, FindingSummary, Kind, ParameterSummary, ProofError, Score, Source, Verdict, read_cases,
    run as run_cases,
};
use crate::recording::{MANIFEST, Recording};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The page of --out.
const PAGE: &str = "proof.html";
/// The same for programs.
const DOCUMENT: &str = "proof.json";

/// Diagnoses concealed cases, then breaks the seal and prints the score.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell prove                                60 cases of the generator
  quell prove --cases 500 --seed 1 --out out the full run, with a page
  quell prove --kinds pair,triple --cases 40 20 cases with two effects, 20 with three
  quell prove --from DIR --json              cases of another generator
  quell prove --seed 2 --out two             a share of a campaign
  quell prove --join one/proof.json two/proof.json
                                             shares together

Each case is a machine in which one piece of physics is hidden, or two, or none, or one that no \
catalogue holds, recorded by sensors with noise; --kinds says which. The diagnosis sees the nominal \
model and one recording. The truth is read after the last diagnosis. DIR holds case-00/model.toml, \
case-00/train/, case-00/test/, ... and truth.json; --keep DIR writes such a folder.")]
pub struct Args {
    /// How many cases to make.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = values::count::<u64>, allow_negative_numbers = true)]
    cases: u64,
    /// The seed; the same seed makes the same cases.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// What the cases hide, in turn [default: drawn for each case, from clean, single, pair and outside].
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = choices::kinds())]
    kinds: Vec<Kind>,
    /// A folder of cases, instead of making them.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["cases", "seed", "kinds", "keep"])]
    from: Option<PathBuf>,
    /// Scores of shares, as --json or --out wrote them, instead of making and diagnosing cases.
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with_all = ["cases", "seed", "kinds", "from", "keep"])]
    join: Vec<PathBuf>,
    /// Keeps the cases in this folder.
    #[arg(long, value_name = "DIR")]
    keep: Option<PathBuf>,
    /// Writes proof.html and proof.json into this folder.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    force: Force,
    /// Prints the score as JSON.
    #[arg(long)]
    json: bool,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError`] where cases cannot be made, read or written.
pub fn run(args: Args) -> Result<(), CliError> {
    let verb = ("prove", args.force);
    let out = args.out.as_deref();
    let reads: Vec<&Path> = args.join.iter().map(PathBuf::as_path).collect();
    let out = out.map(|folder| Out::open(folder, verb, &reads, [PAGE, DOCUMENT]));
    let out = out.transpose()?;
    let keep = args.keep.as_deref();
    let keep = keep.map(|folder| Out::open(folder, verb, &[], kept(args.cases)));
    let keep = keep.transpose()?;
    let keep = keep.as_ref().map(Out::stage).transpose()?;
    let (score, subtitle) = match args.join.as_slice() {
        [] => diagnosed(source(&args, keep.as_ref())?)?,
        files => joined(files)?,
    };
    if let Some(cases) = keep {
        cases.put()?;
    }
    if let Some(out) = &out {
        let stage = out.stage()?;
        stage.file(PAGE, score.page(&subtitle).render())?;
        stage.file(DOCUMENT, format!("{:#}\n", score.to_json()))?;
        stage.put()?;
    }
    if args.json {
        return output::json(&score.to_json());
    }
    let next = next_command(&args);
    output::text(&format!("{subtitle}\n\n{}\n{next}", score.to_text()))
}

/// The next command: to diagnose the first case by hand if the cases are kept; otherwise to keep them.
fn next_command(args: &Args) -> String {
    let folder = args.keep.as_ref().or(args.from.as_ref());
    let Some(folder) = folder else {
        let seed = args.seed.to_string();
        return next::command(["prove", "--cases", "4", "--seed", &seed, "--keep", "cases"]);
    };
    let case = folder.join("case-00");
    let (model, train) = (case.join("model.toml"), case.join("train"));
    next::command([
        "diagnose".as_ref(),
        "--model".as_ref(),
        model.as_path(),
        train.as_path(),
    ])
}

/// Diagnoses all cases of a source.
fn diagnosed(
    (source, count, subtitle): (Source, u64, String),
) -> Result<(Score, String), CliError> {
    let progress = Progress::new(count, "{pos}/{len} cases {wide_bar} {eta}")?;
    let score = run_cases(&source, &verdict, &|| progress.step()).map_err(told)?;
    Ok((score, subtitle))
}

/// One score from several, and a line about it.
fn joined(files: &[PathBuf]) -> Result<(Score, String), CliError> {
    let read = |path: &PathBuf| {
        let wrong = |reason: String| CliError::input(format!("{}: {reason}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|error| wrong(error.to_string()))?;
        Score::from_json(&text).map_err(|error| wrong(error.to_string()))
    };
    let scores = files.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let score = Score::joined(scores);
    let line = format!("{} cases of {} shares", score.cases.len(), files.len());
    Ok((score, line))
}

/// Files of this number of cases, without the channels of their recordings.
fn kept(cases: u64) -> impl Iterator<Item = PathBuf> {
    let of = |number: u64| {
        let case = PathBuf::from(format!("case-{number:02}"));
        let recording = |part: &str| case.join(part).join(MANIFEST);
        let recordings = ["train", "test"].map(recording);
        std::iter::once(case.join("model.toml")).chain(recordings)
    };
    std::iter::once(PathBuf::from("truth.json")).chain((0..cases).flat_map(of))
}

/// The source of the cases, their number, and a line about them.
fn source(args: &Args, keep: Option<&Stage>) -> Result<(Source, u64, String), CliError> {
    if let Some(folder) = &args.from {
        let count = read_cases(folder).map_err(CliError::input)?.len() as u64;
        let line = format!("{} of {}", cases_of(count), folder.display());
        return Ok((Source::Folder(folder.clone()), count, line));
    }
    let &Args { cases, seed, .. } = args;
    let names: Vec<&str> = args.kinds.iter().map(|kind| kind.name()).collect();
    let line = match names.as_slice() {
        [] => format!("{} of seed {seed}", cases_of(cases)),
        names => format!("{} of seed {seed}: {}", cases_of(cases), names.join(", ")),
    };
    let source = Source::Generated {
        cases,
        seed,
        kinds: args.kinds.clone(),
        keep: keep.map(|stage| stage.path().into()),
    };
    Ok((source, cases, line))
}

/// `1 case`, `24 cases`.
fn cases_of(count: u64) -> String {
    format!("{count} case{}", if count == 1 { "" } else { "s" })
}

fn told(error: ProofError) -> CliError {
    match error {
        ProofError::Folder(error) => CliError::input(error),
        ProofError::Plan { .. } => CliError::failure(error),
    }
}

/// Diagnoses one case from its model and training recording alone; the other one scores the model.
fn verdict(path: &Path, train: &Recording, test: &Recording) -> Result<Verdict, String> {
    let model = Model::from_path(path).map_err(|error| error.to_string())?;
    let start = Instant::now();
    let train = std::slice::from_ref(train);
    let outcome = diagnose(&model, train, &[], &Options::default(), &|_, _| {})
        .map_err(|error| error.to_string())?;
    let seconds = start.elapsed().as_secs_f64();
    // The verdict stands even if the other moves cannot be scored.
    let score = score(&outcome.model, test).map(|score| score.rms_over_noise);
    let unscored = |error| tracing::warn!(model = %path.display(), %error, "no score");
    Ok(Verdict {
        test_rms_over_noise: score.map_err(unscored).unwrap_or(f64::NAN),
        seconds,
        ..summary(&outcome.diagnosis)
    })
}

/// A parameter in the units of the truth: the frequency of a mode, displayed in hertz, in rad/s.
fn in_si(parameter: &FittedParameter) -> ParameterSummary {
    let factor = match parameter.unit.as_str() {
        "Hz" => TAU,
        _ => 1.0,
    };
    ParameterSummary {
        name: parameter.name.clone(),
        value: parameter.value * factor,
        ci95: parameter.ci95.map(|edge| edge * factor),
    }
}

fn summary(diagnosis: &Diagnosis) -> Verdict {
    let finding = |finding: &crate::diagnosis::Finding| FindingSummary {
        effect: finding.effect.clone(),
        place: finding.place.clone(),
        alternatives: finding.alternatives.clone(),
        parameters: finding.parameters.iter().map(in_si).collect(),
    };
    let claim = |finding: &crate::diagnosis::Finding| Claim {
        effect: finding.effect.clone(),
        probability: finding.probability,
    };
    Verdict {
        kind: diagnosis.verdict.name().into(),
        findings: diagnosis.findings.iter().map(finding).collect(),
        claims: diagnosis.findings.iter().map(claim).collect(),
        before_over_noise: diagnosis.fit.before.held_out_over_noise,
        after_over_noise: diagnosis.fit.after.held_out_over_noise,
        ..Verdict::default()
    }
}

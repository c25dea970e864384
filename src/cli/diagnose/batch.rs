//! The separate diagnosis of each recording: in this process, or through a queue in others.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::thread::available_parallelism;

use crate::cli::progress::Progress;
use serde_json::json;

use super::Args;
use crate::batch::{
    Batch, BatchError, Folder, InProcess, REPORT, Submission, Submitted, Work, connect, find, work,
};
use crate::cli::answers::{self, told};
use crate::cli::out::Out;
use crate::cli::overview::Overview;
use crate::cli::{CliError, next, output};
use crate::diagnosis::Verdict;
use crate::model::Model;
use crate::page::Page;

/// The word after the address of a queue.
const SUBMIT: &str = "submit";

/// Diagnoses every recording, and prints the results.
///
/// # Errors
/// [`CliError::Input`] where the model is refused, or a recording was set aside or has no statement on it.
pub fn run(args: &Args) -> Result<(), CliError> {
    let verb = ("diagnose --batch", args.force);
    let out = Out::open(&args.out, verb, &[args.model()], [report(args)])?;
    let batch = batch(args, &args.recordings)?;
    let bar = bar(batch.recordings.len())?;
    let cores = available_parallelism().map_or(1, usize::from);
    let at_once = args.jobs.map_or(cores, usize::from);
    let queue = InProcess::new(Folder::open(&args.out).map_err(told)?, at_once);
    let settings = Work {
        at_once,
        threads: cores / at_once,
        drain: false,
    };
    let submission = here(&queue, &batch, settings, &bar).map_err(told)?;
    drop(bar);
    shown(args, &out, &queue, submission)
}

/// The file of the page over all recordings; each share has its own file in the same folder.
fn report(args: &Args) -> String {
    match args.shard {
        Some(shard) => format!("report {shard}.html").replace(' ', "-"),
        None => REPORT.into(),
    }
}

/// Puts every recording into a queue.
///
/// # Errors
/// [`CliError`] where the model or a recording is refused, or the queue does not answer.
pub fn submit(queue: &str, args: &Args) -> Result<(), CliError> {
    let Some((_, recordings)) = args
        .recordings
        .split_first()
        .filter(|(word, rest)| word.as_os_str() == SUBMIT && !rest.is_empty())
    else {
        let error = CliError::input("--queue: the word \"submit\" and recordings belong behind it");
        return Err(error.with_help("quell diagnose --queue URL submit --model FILE DIR"));
    };
    let batch = batch(args, recordings)?;
    let queue = connect(queue).map_err(told)?;
    let bar = bar(batch.recordings.len())?;
    let submission = crate::batch::submit(&*queue, &batch, &mut |_| bar.step());
    drop(bar);
    let submission = submission.map_err(told)?;
    let (queued, waiting) = (submission.queued, submission.waiting);
    let (answered, elsewhere) = (submission.answered, submission.elsewhere);
    match args.json {
        true => output::json(&json!({
            "queued": queued,
            "waiting": waiting,
            "answered": answered,
            "other_shares": elsewhere,
            "keys": submission.keys,
        }))?,
        false => output::text(&format!(
            "queued {queued}, waiting already {waiting}, done already {answered}, of other shares \
             {elsewhere}\n"
        ))?,
    }
    complete(&submission, 0, 0)
}

fn batch(args: &Args, paths: &[PathBuf]) -> Result<Batch, CliError> {
    let file = args.model();
    let read = std::fs::read_to_string(file);
    let model = read.map_err(|error| CliError::input(format!("{}: {error}", file.display())))?;
    // An invalid model is reported here, and not by every worker.
    Model::from_toml(&model, file).map_err(CliError::input)?;
    let mut recordings = Vec::new();
    for path in paths {
        recordings.extend(find(path).map_err(told)?);
    }
    Ok(Batch {
        recordings,
        model,
        seed: args.seed,
        shard: args.shard,
    })
}

/// A progress bar on stderr.
fn bar(count: usize) -> Result<Progress, CliError> {
    Progress::new(count as u64, "{pos}/{len} recordings {wide_bar} {eta}")
}

/// Submits and works at the same time.
fn here(
    queue: &InProcess,
    batch: &Batch,
    settings: Work,
    bar: &Progress,
) -> Result<Submission, BatchError> {
    let ending = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let workers = scope.spawn(|| {
            let worked = work(queue, settings, &ending, &|_| bar.step());
            // The submission must not wait for workers that have failed.
            queue.close();
            worked
        });
        let submission = crate::batch::submit(queue, batch, &mut |submitted| {
            if submitted != Some(Submitted::Queued) {
                bar.step();
            }
        });
        queue.close();
        let broken = |_| Err(BatchError::Thread("the workers broke down".into()));
        workers.join().unwrap_or_else(broken)?;
        submission
    })
}

fn shown(
    args: &Args,
    out: &Out,
    queue: &InProcess,
    submission: Submission,
) -> Result<(), CliError> {
    let folder = queue.folder();
    let (mut answers, mut lines) = (Vec::new(), Vec::new());
    for key in &submission.keys {
        if let Some(answer) = folder.answer(key).map_err(told)? {
            lines.push(answers::line(&answer, folder.of(key).as_deref()));
            answers.push(answer);
        }
    }
    let (set_aside, silent) = (answers::set_aside(&lines), answers::silent(&lines));
    let overview = Overview::new("recording", lines);
    let stage = out.stage()?;
    stage.file(report(args), page(args, &overview).render())?;
    stage.put()?;
    match args.json {
        true => output::json(&answers)?,
        false => output::text(&text(args, &overview))?,
    }
    complete(&submission, set_aside, silent)
}

/// The overall answer, the table, and the command for the worst recording.
fn text(args: &Args, overview: &Overview) -> String {
    let page = args.out.join(report(args));
    let worst = overview.lines.first();
    let model =
        worst.and_then(|line| Some(Path::new(line.report.as_ref()?).with_file_name("model.toml")));
    let next = model.map(|model| {
        let model = args.out.join(model);
        next::command([
            "score".as_ref(),
            model.as_path(),
            "ANOTHER_RECORDING".as_ref(),
        ])
    });
    format!(
        "{}\n\n{}\nMisfits are times the noise. Written: {}\n{}",
        overview.sentence().1,
        overview.text(),
        page.display(),
        next.unwrap_or_default()
    )
}

/// The page over all recordings, with a link to the report of each.
fn page(args: &Args, overview: &Overview) -> Page {
    let (verdict, sentence) = overview.sentence();
    Page::new("Recordings of a batch")
        .subtitle(format!("model {}", args.model().display()))
        .verdict(verdict, sentence)
        .table(overview.table())
}

/// Whether no recording was left out, and every one gave a statement on the model.
fn complete(submission: &Submission, set_aside: usize, silent: usize) -> Result<(), CliError> {
    let refused = &submission.refused;
    if refused.is_empty() && set_aside == 0 && silent == 0 {
        return Ok(());
    }
    let reasons: String = refused
        .iter()
        .map(|(_, why)| format!("\n  {why}"))
        .collect();
    let not = refused.len() + set_aside;
    let of = submission.keys.len() + refused.len();
    let mut parts = Vec::new();
    if not > 0 {
        parts.push(format!("no diagnosis of {not} of {of} recordings{reasons}"));
    }
    if silent > 0 {
        let verdict = Verdict::NotExcited.name();
        parts.push(format!(
            "{silent} of {of} recordings say nothing about the model ({verdict})"
        ));
    }
    Err(CliError::input(parts.join("\n")))
}

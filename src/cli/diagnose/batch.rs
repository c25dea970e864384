//! Each recording by itself: in this process, or into a queue for others.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::thread::available_parallelism;

use crate::cli::progress::Progress;
use serde_json::json;

use super::Args;
use crate::batch::{
    Batch, BatchError, Folder, InProcess, Submission, Submitted, Work, connect, find, work,
};
use crate::cli::answers::{self, Row, told};
use crate::cli::{CliError, output};
use crate::diagnosis::Verdict;
use crate::model::Model;

/// The word behind the address of a queue.
const SUBMIT: &str = "submit";

/// Diagnoses every recording, and shows what came out.
///
/// # Errors
/// [`CliError::Input`] where the model is refused, or a recording was set aside or says nothing of it.
pub fn run(args: &Args) -> Result<(), CliError> {
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
    shown(args, &queue, submission)
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
    // What is wrong with it is told here, and not by every worker.
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

/// Told on stderr.
fn bar(count: usize) -> Result<Progress, CliError> {
    Progress::new(count as u64, "{pos}/{len} recordings {wide_bar} {eta}")
}

/// Puts in and works at once.
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
            // Who puts in must not wait for workers that have failed.
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

fn shown(args: &Args, queue: &InProcess, submission: Submission) -> Result<(), CliError> {
    let mut answers = Vec::new();
    for key in &submission.keys {
        answers.extend(queue.folder().answer(key).map_err(told)?);
    }
    let rows: Vec<_> = answers.iter().map(Row::of).collect();
    match args.json {
        true => output::json(&answers)?,
        false => output::text(&answers::table(&rows))?,
    }
    complete(
        &submission,
        answers::set_aside(&rows),
        answers::silent(&rows),
    )
}

/// Whether nothing was left out, and every recording said something.
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
            "{silent} of {of} recordings say nothing of the model ({verdict})"
        ));
    }
    Err(CliError::input(parts.join("\n")))
}

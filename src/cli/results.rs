//! `quell results`: the results of a queue.

use std::path::PathBuf;

use super::answers::{self, told};
use super::overview::Overview;
use super::{CliError, next, output};
use crate::batch::{BatchError, Folder, connect};

/// Shows what came out of the recordings in a queue, and how many are left.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  quell results --queue nats://host:4222
  quell results --queue nats://host:4222 --out fleet-results
  quell results --queue nats://host:4222 --json

The folder of --out gets a folder for each recording, with diagnosis.json, model.toml with the physics \
in it, and result.json, which says what they are of. misfit and with it: of the model as it was given, \
refitted, and with what is missing, over the noise, on moves that neither was fitted to.")]
pub struct Args {
    /// Address of the queue, as nats://host:4222.
    #[arg(long, value_name = "URL")]
    queue: String,
    /// A folder for the results.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Prints the results as JSON, one a line.
    #[arg(long)]
    json: bool,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError`] where the queue does not answer, or the folder is refused.
pub fn run(args: Args) -> Result<(), CliError> {
    let queue = connect(&args.queue).map_err(told)?;
    let folder = args.out.as_deref().map(Folder::open).transpose();
    let folder = folder.map_err(told)?;
    let left = queue.left().map_err(told)?;
    let (mut lines, mut printed) = (Vec::new(), Ok(()));
    let each = &mut |answer| -> Result<(), BatchError> {
        if let Some(folder) = &folder {
            folder.store(&answer)?;
        }
        lines.push(answers::line(&answer, None));
        if args.json && printed.is_ok() {
            printed = line(&answer);
        }
        Ok(())
    };
    queue.answers(each).map_err(told)?;
    printed?;
    if args.json {
        return Ok(());
    }
    let (done, aside) = (lines.len(), answers::set_aside(&lines));
    let silent = answers::silent(&lines);
    output::text(&format!(
        "{}\n{done} done, {aside} of them set aside, {silent} not excited, {left} left\n\n{}",
        Overview::new("recording", lines).text(),
        next_command(&args, left)
    ))
}

/// The next command: to work on the remaining recordings, or to get the results as files.
fn next_command(args: &Args, left: u64) -> String {
    match (left, &args.out) {
        (0, None) => next::command(["results", "--queue", &args.queue, "--out", "out"]),
        (0, Some(_)) => String::new(),
        _ => next::command(["work", "--queue", &args.queue]),
    }
}

fn line(answer: &crate::batch::Answer) -> Result<(), CliError> {
    let text = serde_json::to_string(answer).map_err(CliError::failure)?;
    output::text(&format!("{text}\n"))
}

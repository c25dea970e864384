//! `quell score`: how well a model predicts a recording that it has never seen.

use super::{CliError, next, output};
use crate::diagnosis::judge;
use crate::model::Model;
use crate::recording::Recording;
use crate::report::judgement_lines;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Scores a model on a recording: its error over the noise.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  quell score model.toml arm7
  quell score out/model.toml test/recording.toml --json
  quell score out/model.toml test/recording.toml --first 50

Only the clock offset, the output's offset, the sensor's frame and a start that no sensor says are fitted; the \
model's parameters and effects are taken as they stand. A model that lacks nothing has an rms of once the noise. \
Where the manifest has a payload, the score with the link's inertia fitted stands beside. \
With --first they are fitted to the first samples, and the score is of the free run that follows.")]
pub struct Args {
    /// The model, such as the one that `quell diagnose` wrote.
    pub model: PathBuf,
    /// The manifest, the folder that holds its recording.toml, or an MCAP file.
    pub recording: PathBuf,
    /// Fits offsets, clocks and start to the first N samples alone, and judges by those that follow.
    #[arg(long, value_name = "N")]
    pub first: Option<NonZeroUsize>,
    /// Prints JSON instead of text.
    #[arg(long)]
    pub json: bool,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where model or recording is refused.
pub fn run(args: Args) -> Result<(), CliError> {
    let model = Model::from_path(&args.model).map_err(CliError::input)?;
    let recording = Recording::from_path(&args.recording)?;
    let judgement = judge(&model, recording, args.first).map_err(CliError::input)?;
    match args.json {
        true => output::json(&judgement),
        false => output::text(&format!(
            "{}\n{}",
            judgement_lines(&judgement),
            next::command([
                "diagnose".as_ref(),
                "--model".as_ref(),
                args.model.as_path(),
                args.recording.as_path()
            ])
        )),
    }
}

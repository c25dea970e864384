//! The modes for a shaper: typed, from a model, or from a recording.

use super::identify::Identified;
use super::{CliError, next, values};
use crate::identification::ToldMode;
use crate::identification::stop::never;
use crate::recording::Recording;
use crate::signal::TipRegistration;
use quell_shapers::Mode;
use std::path::{Path, PathBuf};

/// Where the modes come from.
#[derive(Clone, Debug, clap::Args)]
#[group(id = "modes", multiple = false)]
pub struct ModeArgs {
    /// Natural frequency in Hz and damping ratio; several modes are shaped for at once.
    #[arg(long, value_name = "F,XI", value_parser = values::mode, allow_hyphen_values = true)]
    pub mode: Vec<Mode>,
    /// The model of the joint instead of --mode, as `quell identify` writes it: all its modes, with their standard
    /// deviations.
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// A recording instead of --mode: manifest, folder, MCAP, CSV or Parquet file. The modes are what `quell identify` finds
    /// in it.
    #[arg(long, value_name = "RECORDING")]
    pub recording: Option<PathBuf>,
}

impl ModeArgs {
    /// The modes, with what their source knows of each; empty if the arguments name no source of them.
    ///
    /// # Errors
    /// [`CliError::Input`] where model or recording is refused, or gives no mode.
    pub fn told(&self) -> Result<Vec<ToldMode>, CliError> {
        if let Some(file) = &self.model {
            return Ok(ToldMode::of_model(file)?);
        }
        let Some(file) = &self.recording else {
            return Ok(self.mode.iter().copied().map(ToldMode::from).collect());
        };
        let recording = Recording::from_path(file)?;
        let found = Identified::of(
            vec![(file.clone(), recording)],
            None,
            TipRegistration::Arc,
            &never,
        )?;
        let modes: Vec<ToldMode> = found.modes().into_iter().map(ToldMode::from).collect();
        match modes.is_empty() {
            true => Err(CliError::input(format!(
                "{}: it tells no mode",
                file.display()
            ))),
            false => Ok(modes),
        }
    }

    /// The options for these modes in a command that follows: the same file, or each mode.
    pub fn options(&self, modes: &[Mode]) -> Vec<String> {
        let file = |option: &str, file: &Path| vec![option.into(), file.display().to_string()];
        match (&self.model, &self.recording) {
            (Some(model), _) => file("--model", model),
            (_, Some(recording)) => file("--recording", recording),
            _ => next::modes(modes).collect(),
        }
    }
}

//! The modes for a shaper: typed, from a model, or from a recording.

use super::identify::Identified;
use super::{CliError, values};
use crate::identification::NominalModel;
use crate::identification::stop::never;
use crate::recording::Recording;
use crate::signal::TipRegistration;
use quell_shapers::Mode;
use std::path::PathBuf;

/// Where the modes come from.
#[derive(Clone, Debug, clap::Args)]
#[group(id = "modes", multiple = false)]
pub struct ModeArgs {
    /// Natural frequency in Hz and damping ratio; several modes are shaped for at once.
    #[arg(long, value_name = "F,XI", value_parser = values::mode, allow_hyphen_values = true)]
    pub mode: Vec<Mode>,
    /// The model of the joint instead of --mode, as `quell identify` writes it.
    #[arg(long, value_name = "FILE")]
    pub model: Option<PathBuf>,
    /// A recording instead of --mode: manifest, folder, MCAP, CSV or Parquet file. The modes are what `quell identify` finds
    /// in it.
    #[arg(long, value_name = "RECORDING")]
    pub recording: Option<PathBuf>,
}

impl ModeArgs {
    /// The modes; empty if the arguments name no source of them.
    ///
    /// # Errors
    /// [`CliError::Input`] where model or recording is refused, or gives no mode.
    pub fn modes(&self) -> Result<Vec<Mode>, CliError> {
        if let Some(file) = &self.model {
            return Ok(vec![NominalModel::from_path(file)?.mode]);
        }
        let Some(file) = &self.recording else {
            return Ok(self.mode.clone());
        };
        let recording = Recording::from_path(file)?;
        let found = Identified::of(
            vec![(file.clone(), recording)],
            None,
            TipRegistration::Arc,
            &never,
        )?;
        let modes: Vec<Mode> = found.modes().iter().map(|known| known.mode).collect();
        match modes.is_empty() {
            true => Err(CliError::input(format!(
                "{}: it tells no mode",
                file.display()
            ))),
            false => Ok(modes),
        }
    }
}

//! The files of `quell move`: the report, the belief, and a recording of each move.

use std::path::{Path, PathBuf};

use super::page;
use crate::cli::out::{Force, Out, recording_files};
use crate::cli::{CliError, next};
use crate::closed_loop::{Comparison, MoveKind, Scenario};
use crate::model::believed;

/// The report.
pub const REPORT: &str = "report.html";
/// The nominal model of the joint.
const MODEL: &str = "model.toml";

/// The folder, if all files to be written are allowed there.
///
/// # Errors
/// [`CliError::Input`] where one of the files must not be replaced.
pub fn open(folder: &Path, force: Force, reads: &[&Path]) -> Result<Out, CliError> {
    let recordings = MoveKind::ALL.map(|kind| recording_files(kind.name()));
    let names = [REPORT, MODEL].map(PathBuf::from).into_iter();
    let names = names.chain(recordings.into_iter().flatten());
    Out::open(folder, ("move", force), reads, names)
}

/// The next command: to identify the unshaped move, which vibrates most, from the nominal model.
pub fn next_command(folder: &Path) -> String {
    let recording = folder.join(MoveKind::Unshaped.name());
    let words = [
        Path::new("identify"),
        &recording,
        Path::new("--model"),
        &folder.join(MODEL),
    ];
    next::command(words.into_iter().chain([Path::new("--out"), folder]))
}

/// Writes `report.html`, `model.toml` with the belief, and one recording a move.
///
/// # Errors
/// [`CliError`] where a file must not be replaced, or the disk refuses.
pub fn write(out: &Out, scenario: &Scenario, comparison: &Comparison) -> Result<(), CliError> {
    let stage = out.stage()?;
    for (kind, trace) in comparison.moves() {
        let folder = stage.path().join(kind.name());
        trace
            .recording
            .write(&folder, true)
            .map_err(CliError::failure)?;
    }
    let model = believed::flexible_joint(scenario.belief, Some(&comparison.unshaped().arc));
    stage.file(MODEL, model)?;
    stage.file(REPORT, page::page(scenario, comparison).render())?;
    stage.put()?;
    Ok(())
}

//! What `quell move` writes: the report, and a recording of each move.

use std::path::{Path, PathBuf};

use super::page;
use crate::cli::{CliError, output};
use crate::closed_loop::{Comparison, Scenario};
use crate::model::believed;

/// Writes `report.html`, `model.toml` with the belief, and one recording a move; returns the
/// report's path.
pub fn write(
    folder: &Path,
    scenario: &Scenario,
    comparison: &Comparison,
) -> Result<PathBuf, CliError> {
    output::folder(folder)?;
    for (kind, trace) in &comparison.moves {
        let folder = folder.join(kind.name());
        trace
            .recording
            .write(&folder, true)
            .map_err(CliError::failure)?;
    }
    let model = believed::flexible_joint(scenario.belief, Some(&comparison.moves[0].1.arc));
    output::file(&folder.join("model.toml"), model)?;
    let report = folder.join("report.html");
    page::page(scenario, comparison)
        .write(&report)
        .map_err(CliError::failure)?;
    Ok(report)
}

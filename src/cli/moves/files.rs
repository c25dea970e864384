//! What `quell move` writes: the report, and a recording of each move.

use std::path::{Path, PathBuf};

use super::page;
use crate::cli::{CliError, output};
use crate::closed_loop::{Comparison, Scenario};

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
    output::file(&folder.join("model.toml"), model(scenario, comparison))?;
    let report = folder.join("report.html");
    page::page(scenario, comparison)
        .write(&report)
        .map_err(CliError::failure)?;
    Ok(report)
}

/// The belief as a model file, for `quell identify --model`.
fn model(scenario: &Scenario, comparison: &Comparison) -> String {
    let arc = comparison.moves[0].1.arc;
    format!(
        "kind = \"flexible_joint\"\nnatural_frequency_hz = {}\ndamping_ratio = {}\n\
         lever_arm_m = {}\ntip_height_m = {}\n",
        scenario.belief.hertz(),
        scenario.belief.damping_ratio(),
        arc.radius(),
        arc.centre().z,
    )
}

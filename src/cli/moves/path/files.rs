//! The files of `quell move --path`: the report, the beliefs, and a recording of each joint in each move.

use std::path::{Path, PathBuf};

use super::page;
use crate::cli::out::{Force, Out, recording_files};
use crate::cli::{CliError, next};
use crate::closed_loop::{PathComparison, PathKind, PathScenario};
use crate::model::believed;

/// The report.
pub const REPORT: &str = "report.html";

/// The folder, if all files to be written are allowed there.
///
/// # Errors
/// [`CliError::Input`] where one of the files must not be replaced.
pub fn open(
    folder: &Path,
    force: Force,
    reads: &[&Path],
    scenario: &PathScenario,
) -> Result<Out, CliError> {
    let mut names = vec![PathBuf::from(REPORT)];
    for joint in scenario.joints.iter().map(|joint| joint.joint) {
        names.push(model(joint).into());
        for kind in PathKind::ALL {
            names.extend(recording_files(&recording(kind, joint)));
        }
    }
    Out::open(folder, ("move", force), reads, names)
}

/// The folder of a joint's recording.
fn recording(kind: PathKind, joint: usize) -> String {
    format!("{}/joint_{}", kind.name(), joint + 1)
}

/// The file of a joint's nominal model.
fn model(joint: usize) -> String {
    format!("model_joint_{}.toml", joint + 1)
}

/// The next command: to identify the first joint that vibrates, in the unshaped move.
pub fn next_command(folder: &Path, scenario: &PathScenario) -> String {
    let Some(first) = scenario.joints.iter().find(|joint| joint.belief.is_some()) else {
        return String::new();
    };
    let recording = folder.join(recording(PathKind::Unshaped, first.joint));
    let model = folder.join(model(first.joint));
    let words = [
        Path::new("identify"),
        &recording,
        Path::new("--model"),
        &model,
    ];
    next::command(words.into_iter().chain([Path::new("--out"), folder]))
}

/// Writes `report.html`, a model of each joint that vibrates, and a recording of each joint in each move.
///
/// # Errors
/// [`CliError`] where a file must not be replaced, or the disk refuses.
pub fn write(
    out: &Out,
    scenario: &PathScenario,
    comparison: &PathComparison,
) -> Result<(), CliError> {
    let stage = out.stage()?;
    for (kind, trace) in &comparison.moves {
        for (joint, one) in scenario.joints.iter().zip(&trace.joints) {
            let folder = stage.path().join(recording(*kind, joint.joint));
            one.recording
                .write(&folder, true)
                .map_err(CliError::failure)?;
        }
    }
    for (joint, one) in scenario.joints.iter().zip(&comparison.moves[0].1.joints) {
        if let Some(belief) = joint.belief {
            stage.file(
                model(joint.joint),
                believed::flexible_joint(belief, Some(&one.arc)),
            )?;
        }
    }
    stage.file(REPORT, page::page(scenario, comparison).render())?;
    stage.put()?;
    Ok(())
}

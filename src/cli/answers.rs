//! Short forms of the answers of a batch.

use serde_json::Value;
use std::path::Path;

use super::CliError;
use super::overview::{Line, Told};
use crate::batch::{Answer, BatchError, REPORT};
use crate::diagnosis::Verdict;
use crate::effects::Catalogue;

/// The line of an answer in an overview, with its report if it is in a folder beside the overview.
pub fn line(answer: &Answer, folder: Option<&Path>) -> Line {
    let name = folder.and_then(Path::file_name);
    let report = folder.is_some_and(|folder| folder.join(REPORT).is_file());
    Line {
        name: answer.about.name.clone(),
        report: name
            .filter(|_| report)
            .map(|name| format!("{}/{REPORT}", name.to_string_lossy())),
        told: match (&answer.about.error, &answer.diagnosis) {
            (Some(error), _) => Err(error.clone()),
            (None, Some(diagnosis)) => told_of(diagnosis),
            (None, None) => Err("its answer has no diagnosis".into()),
        },
    }
}

/// The content of a diagnosis, read from the document of whichever version wrote it.
fn told_of(diagnosis: &Value) -> Result<Told, String> {
    let text = |key: &str| {
        diagnosis
            .get(key)
            .and_then(Value::as_str)
            .unwrap_or_default()
    };
    let verdict: Verdict = serde_json::from_value(text("verdict").into())
        .map_err(|error| format!("its diagnosis cannot be read: {error}"))?;
    let over_noise = |which: &str| {
        let path = format!("/fit/{which}/held_out_over_noise");
        diagnosis
            .pointer(&path)
            .and_then(Value::as_f64)
            .unwrap_or(f64::NAN)
    };
    let findings = diagnosis.get("findings").and_then(Value::as_array);
    let names = findings.into_iter().flatten();
    let names = names.filter_map(|finding| finding.get("effect")?.as_str());
    Ok(Told {
        verdict,
        summary: text("summary").into(),
        missing: names.map(|name| Catalogue::default().title(name)).collect(),
        before: over_noise("before"),
        after: over_noise("after"),
    })
}

/// Number of recordings that were set aside.
pub fn set_aside(lines: &[Line]) -> usize {
    lines.iter().filter(|line| line.told.is_err()).count()
}

/// Number of diagnoses without a statement on the model.
pub fn silent(lines: &[Line]) -> usize {
    let silent = |told: &Told| told.verdict == Verdict::NotExcited;
    lines
        .iter()
        .filter(|line| line.told.as_ref().is_ok_and(silent))
        .count()
}

/// The error of the command line: the user's errors are bad input, the system's a failure.
pub fn told(error: BatchError) -> CliError {
    match error {
        BatchError::Recording(error) => error.into(),
        BatchError::Disk { .. } | BatchError::Thread(_) | BatchError::Closed => {
            CliError::failure(error)
        }
        BatchError::Queue { .. } => CliError::failure(error),
        _ => CliError::input(error),
    }
}

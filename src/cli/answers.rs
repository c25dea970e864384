//! Answers of a batch: a line of a table for each, and what was set aside.

use serde_json::Value;

use super::CliError;
use crate::batch::{Answer, BatchError};
use crate::diagnosis::Verdict;
use crate::page::{columns, number};

/// One answer in a table.
pub struct Row {
    cells: [String; 5],
    /// Why there is no diagnosis.
    error: Option<String>,
    /// Whether the recording says nothing of the model.
    silent: bool,
}

impl Row {
    /// The line for an answer.
    pub fn of(answer: &Answer) -> Self {
        let about = &answer.about;
        let diagnosis = answer.diagnosis.as_ref();
        let verdict = answer.said("verdict").unwrap_or("set aside");
        let silent = verdict == Verdict::NotExcited.name();
        let over_noise = |which: &str| {
            let path = format!("/fit/{which}/held_out_over_noise");
            let value = diagnosis.and_then(|one| one.pointer(&path)?.as_f64());
            value.filter(|_| !silent).map_or("-".into(), number)
        };
        let missing = diagnosis.map_or_else(String::new, effects);
        Self {
            cells: [
                about.name.clone(),
                verdict.to_string(),
                if missing.is_empty() {
                    "-".into()
                } else {
                    missing
                },
                over_noise("before"),
                over_noise("after"),
            ],
            error: about.error.clone(),
            silent,
        }
    }

    fn set_aside(&self) -> Option<String> {
        let error = self.error.as_ref()?;
        Some(format!("{}: {error}\n", self.cells[0]))
    }
}

/// The rows as a table, and below it why what was set aside was.
pub fn table(rows: &[Row]) -> String {
    let header = ["recording", "verdict", "missing", "misfit", "with it"];
    let cells = rows.iter().map(|row| row.cells.clone());
    let errors: String = rows.iter().filter_map(Row::set_aside).collect();
    let gap = if errors.is_empty() { "" } else { "\n" };
    format!("{}{gap}{errors}", columns(header, cells))
}

/// How many were set aside.
pub fn set_aside(rows: &[Row]) -> usize {
    rows.iter().filter(|row| row.error.is_some()).count()
}

/// How many say nothing of the model: neither healthy nor ill.
pub fn silent(rows: &[Row]) -> usize {
    rows.iter().filter(|row| row.silent).count()
}

/// The physics that is missing, as one word.
fn effects(diagnosis: &Value) -> String {
    let findings = diagnosis.get("findings").and_then(Value::as_array);
    let names = findings.into_iter().flatten();
    let names = names.filter_map(|finding| finding.get("effect")?.as_str());
    names.collect::<Vec<_>>().join(" + ")
}

/// An error of the user's is bad input, one of the system's a failure.
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

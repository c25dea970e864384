//! Errors of a recording, with its name.

use crate::cli::CliError;
use crate::identification::IdentificationError;

/// An error of a recording, with its name where it does not say it.
pub fn of_recording(name: &str, error: IdentificationError) -> CliError {
    let text = error.to_string();
    let says_it = text.contains(&format!("{name:?}"));
    match matches!(error, IdentificationError::Stopped) || says_it {
        true => error.into(),
        false => CliError::input(format!("{name:?}: {text}")),
    }
}

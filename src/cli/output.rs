//! The output of a verb: text, tables, JSON and folders of files.

use super::CliError;
use serde::Serialize;
use std::io::{self, Write};
use std::path::Path;

/// Prints text on stdout as it is.
///
/// # Errors
/// [`CliError::BrokenPipe`] where nobody reads on.
pub fn text(text: &str) -> Result<(), CliError> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    Ok(stdout.flush()?)
}

/// Prints a value as indented JSON and a line end. Numbers that are not finite become `null`.
///
/// # Errors
/// As [`text`].
pub fn json(value: &impl Serialize) -> Result<(), CliError> {
    let mut line = serde_json::to_string_pretty(value).map_err(CliError::failure)?;
    line.push('\n');
    text(&line)
}

/// Makes the folder of `--out`, with its parents, where it is not there yet.
///
/// # Errors
/// [`CliError::Input`] that names the folder.
pub fn folder(path: &Path) -> Result<(), CliError> {
    std::fs::create_dir_all(path).map_err(|error| {
        CliError::input(format!(
            "cannot make the folder {}: {error}",
            path.display()
        ))
    })
}

/// Writes one file into the folder of `--out`.
///
/// # Errors
/// [`CliError::Failure`] that names the file.
pub fn file(path: &Path, bytes: impl AsRef<[u8]>) -> Result<(), CliError> {
    tracing::info!(file = %path.display(), "writing");
    std::fs::write(path, bytes)
        .map_err(|error| CliError::failure(format!("cannot write {}: {error}", path.display())))
}

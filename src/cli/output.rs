//! What a verb prints and writes: text, tables, JSON and folders of files.

use super::CliError;
use comfy_table::{CellAlignment, Table, presets};
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

/// Rows under a header, as plain text in columns: the first column to the left, the others, which
/// hold figures, to the right; two spaces between columns and none at the line's end.
pub fn table<const N: usize>(
    header: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    let mut table = Table::new();
    table
        .load_preset(presets::NOTHING)
        .set_header(header)
        .add_rows(rows);
    for column in table.column_iter_mut() {
        let first = column.index == 0;
        column.set_padding((if first { 0 } else { 2 }, 0));
        column.set_cell_alignment(if first {
            CellAlignment::Left
        } else {
            CellAlignment::Right
        });
    }
    table.trim_fmt() + "\n"
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_lines_are_trimmed() {
        let rows = [["zv".into(), "0.061".into()], ["zvdd".into(), "0.2".into()]];
        let expected = "shaper  time_s\nzv       0.061\nzvdd       0.2\n";
        assert_eq!(table(["shaper", "time_s"], rows), expected);
    }
}

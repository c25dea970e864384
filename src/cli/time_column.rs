//! The column of a command's CSV file with the time.

use super::CliError;
use crate::recording::Table;

/// Names of a column with seconds that are recognised without `--time`.
const TIME_NAMES: [&str; 4] = ["time_s", "t_s", "time", "t"];

/// The column of `--time`, or else one with a known name.
///
/// # Errors
/// [`CliError::Input`] where that column is one of those named by `--column`.
pub fn time_column<'a>(
    table: &Table,
    given: Option<&'a str>,
    columns: &[String],
) -> Result<Option<&'a str>, CliError> {
    let is_held = |name: &&str| table.header().iter().any(|held| held == name);
    let name = given.or_else(|| TIME_NAMES.into_iter().find(is_held));
    match name.filter(|name| columns.iter().any(|column| column == name)) {
        Some(name) => Err(CliError::input(format!(
            "--column {name}: it is the time, not a command"
        ))),
        None => Ok(name),
    }
}

//! `quell init`: asks what a CSV file does not say of itself, and writes its manifest.

mod questions;

use super::out::Force;
use super::{CliError, inspect};
use crate::recording::is_csv;
use questions::Questions;
use std::io;
use std::path::PathBuf;

/// Asks what a CSV or Parquet file does not say of itself, and writes its recording.toml.
///
/// It takes what `quell inspect` proposes, and asks for what is guessed and for what nothing tells: roles, units, the unit of the time,
/// the rate. An empty answer keeps what is guessed, and leaves out a column of which nothing tells what it is.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell init decay.csv
  quell init decay.csv < /dev/null     (asks nobody: keeps what is guessed)
  printf 'tip_acceleration\\ng\\n' | quell init numbers.csv

Questions are on stderr, answers are lines of stdin. The answer none leaves out a guessed scale, offset or period.")]
pub struct Args {
    /// The CSV or Parquet file, or a folder of them.
    pub file: PathBuf,
    #[command(flatten)]
    force: Force,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError::Input`] where the file is refused, or nobody says what has to be known.
pub fn run(args: Args) -> Result<(), CliError> {
    let Args { file, force } = args;
    if !is_csv(&file) && !file.is_dir() {
        let error = CliError::input(format!("{}: no CSV or Parquet file", file.display()));
        return Err(error.with_help("quell inspect tells what another recording holds"));
    }
    let mut questions = Questions::new(io::stdin().lock(), io::stderr());
    inspect::propose(&file, ("init", force), false, |text| {
        questions.answered(text)
    })
}

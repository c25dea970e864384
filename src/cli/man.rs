//! `quell man`: the manual pages.

use super::{CliError, command, output};
use clap_mangen::Man;
use std::path::PathBuf;

/// Prints the manual page, or writes one for each verb.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell man | man -l -
  quell man --out ~/.local/share/man/man1")]
pub struct Args {
    /// The folder for quell.1 and a page for each verb, as quell-move.1.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError`] where a page cannot be written.
pub fn run(args: Args) -> Result<(), CliError> {
    match args.out {
        Some(folder) => {
            output::folder(&folder)?;
            clap_mangen::generate_to(command(), &folder).map_err(CliError::failure)
        }
        None => {
            let mut page = Vec::new();
            Man::new(command()).render(&mut page)?;
            output::text(&String::from_utf8_lossy(&page))
        }
    }
}

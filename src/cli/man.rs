//! `quell man`: the manual pages.

use super::{CliError, ENVIRONMENT, command, output};
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};
use std::io::Write;
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
            clap_mangen::generate_to(command(), &folder).map_err(CliError::failure)?;
            let page = std::fs::File::create(folder.join("quell.1"));
            write_main(&mut page.map_err(CliError::failure)?)
        }
        None => {
            let mut page = Vec::new();
            write_main(&mut page)?;
            output::text(&String::from_utf8_lossy(&page))
        }
    }
}

/// Writes the page of `quell` itself, with the variables of the environment. The verb `help` has no page.
fn write_main(out: &mut dyn Write) -> Result<(), CliError> {
    Man::new(command().disable_help_subcommand(true)).render(out)?;
    let mut environment = Roff::new();
    environment.control("SH", ["ENVIRONMENT"]);
    for [name, what] in ENVIRONMENT {
        environment.control("TP", []);
        environment.text([bold(name)]);
        environment.text([roman(what)]);
    }
    Ok(write!(out, "{}", environment.to_roff())?)
}

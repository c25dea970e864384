//! `quell serve` in a program that is built without the service.

use super::CliError;

/// Commands a robot in real time. This program is built without it: build it with the feature `serve`.
#[derive(clap::Args)]
pub struct Args {
    /// The arguments of the service, unread.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    pub any: Vec<String>,
}

/// Explains how to build it.
///
/// # Errors
/// Always [`CliError::Input`].
pub fn run(_: Args) -> Result<(), CliError> {
    Err(CliError::input("this program is built without the service")
        .with_help("build it with: cargo build --release --features serve"))
}

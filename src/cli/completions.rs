//! `quell completions`: completions of `quell` for a shell.

use super::{CliError, command, output};
use clap_complete::Shell;

/// Prints the completions of a shell.
#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  quell completions bash > ~/.local/share/bash-completion/completions/quell
  quell completions zsh > ~/.zfunc/_quell
  quell completions fish > ~/.config/fish/completions/quell.fish")]
pub struct Args {
    /// The shell.
    shell: Shell,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError::BrokenPipe`] where nobody reads on.
pub fn run(args: Args) -> Result<(), CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command(), "quell", &mut script);
    output::text(&String::from_utf8_lossy(&script))
}

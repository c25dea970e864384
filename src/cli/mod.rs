//! The command line: `quell <verb>`, one file a verb.
//!
//! A verb is a file with `#[derive(clap::Args)] pub struct Args` and
//! `pub fn run(args: Args) -> Result<(), CliError>`, plus one line in each of `Verb` and `Verb::run`. It prints
//! through [`output`], so that a closed pipe ends it quietly. It writes through [`out`], so that no file of the
//! user's is overwritten.

pub mod answers;
pub mod choices;
pub mod compare;
pub mod completions;
pub mod diagnose;
pub mod doctor;
pub mod effort;
pub mod error;
pub mod identify;
pub mod init;
pub mod inspect;
pub mod log;
pub mod man;
pub mod mode_args;
pub mod moves;
pub mod next;
pub mod out;
pub mod output;
pub mod overview;
pub mod progress;
pub mod prove;
pub mod results;
pub mod robot_args;
pub mod score;
#[cfg(feature = "serve")]
pub mod serve;
#[cfg(not(feature = "serve"))]
#[path = "serve_absent.rs"]
pub mod serve;
pub mod shape;
pub mod shaping;
pub mod simulate;
pub mod time_column;
pub mod values;
pub mod work;

pub use error::CliError;

use clap::{CommandFactory, Parser, Subcommand};
use std::ffi::OsString;
use std::process::ExitCode;

/// Adaptive input shaping for flexible robot joints.
#[derive(Parser)]
#[command(
    name = "quell",
    version,
    propagate_version = true,
    arg_required_else_help = true,
    after_help = "Exit codes: 0 done, 1 failed, 2 bad input (refused, or it says nothing). Every verb's --help shows an example."
)]
struct Cli {
    /// Tells more on stderr: -v what is done, -vv the details (or set QUELL_LOG).
    #[arg(short, long, global = true, display_order = 1000, action = clap::ArgAction::Count)]
    verbose: u8,
    /// Tells only errors on stderr: no warnings, no progress.
    #[arg(
        short,
        long,
        global = true,
        display_order = 1001,
        conflicts_with = "verbose"
    )]
    quiet: bool,
    #[command(subcommand)]
    verb: Verb,
}

/// What the environment says, for the manual and the book: each variable and what it does.
pub const ENVIRONMENT: [[&str; 2]; 2] = [
    [
        "NO_COLOR",
        "set and not empty: no colours. There are none either where the output is no terminal",
    ],
    [
        "QUELL_LOG",
        "a filter of the log, as `quell=debug`, instead of `-v`",
    ],
];

/// What the help of a verb that needs NATS opens with in a program without it.
#[cfg(not(feature = "nats"))]
const NO_NATS: &str = "This program is built without NATS, which this verb needs. Build it with:\n  \
                       cargo build --release --features nats";

/// The verbs of `quell`.
#[derive(Subcommand)]
enum Verb {
    Compare(compare::Args),
    Completions(completions::Args),
    Diagnose(diagnose::Args),
    Doctor(doctor::Args),
    Identify(identify::Args),
    Init(init::Args),
    Inspect(inspect::Args),
    Man(man::Args),
    Move(moves::Args),
    Prove(prove::Args),
    #[cfg_attr(not(feature = "nats"), command(hide = true, before_help = NO_NATS))]
    Results(results::Args),
    Score(score::Args),
    #[command(hide = cfg!(not(feature = "serve")))]
    Serve(serve::Args),
    Shape(shape::Args),
    Simulate(simulate::Args),
    #[cfg_attr(not(feature = "nats"), command(hide = true, before_help = NO_NATS))]
    Work(work::Args),
}

impl Verb {
    fn run(self) -> Result<(), CliError> {
        match self {
            Self::Compare(args) => compare::run(args),
            Self::Completions(args) => completions::run(args),
            Self::Diagnose(args) => diagnose::run(args),
            Self::Doctor(args) => doctor::run(args),
            Self::Identify(args) => identify::run(args),
            Self::Init(args) => init::run(args),
            Self::Inspect(args) => inspect::run(args),
            Self::Man(args) => man::run(args),
            Self::Move(args) => moves::run(args),
            Self::Prove(args) => prove::run(args),
            Self::Results(args) => results::run(args),
            Self::Score(args) => score::run(args),
            Self::Serve(args) => serve::run(args),
            Self::Shape(args) => shape::run(args),
            Self::Simulate(args) => simulate::run(args),
            Self::Work(args) => work::run(args),
        }
    }
}

/// The whole command line, as used by completions, the manual page and the reference of the book.
pub fn command() -> clap::Command {
    Cli::command()
}

/// Runs the command of the process; the whole of `main`.
pub fn main() -> ExitCode {
    main_from(std::env::args_os()).into()
}

/// Runs a command, whose first word is the name of the program, and returns its exit code. Invalid arguments
/// and the help end the process.
pub fn main_from(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let Cli {
        verbose,
        quiet,
        verb,
    } = Cli::parse_from(arguments);
    log::start(verbose, quiet);
    match verb.run() {
        Ok(()) => 0,
        Err(error) => error.report(),
    }
}

//! Tracing to stderr, by `QUELL_LOG` or `-v`.

use super::progress;
use std::io::{self, IsTerminal};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

/// Starts the log. The filter is `QUELL_LOG` (such as `quell=debug`) if it is set and valid. Otherwise:
/// warnings by default, `-v` for each action, `-vv` for details, `-vvv` for everything, `-q` for errors alone.
/// In colours on a terminal, unless `NO_COLOR` is set.
pub fn start(verbose: u8, quiet: bool) {
    let level = match verbose {
        _ if quiet => LevelFilter::ERROR,
        0 => LevelFilter::WARN,
        1 => LevelFilter::INFO,
        2 => LevelFilter::DEBUG,
        _ => LevelFilter::TRACE,
    };
    progress::silence(quiet);
    let wanted = std::env::var("QUELL_LOG").ok();
    let wanted = wanted.and_then(|filter| filter.parse::<Targets>().ok());
    let filter = wanted.unwrap_or_else(|| Targets::new().with_default(level));
    // A log that cannot be written (a full disk) must not end the logged work: by default the subscriber would
    // print its own failure, and panic if that fails, too.
    let lines = tracing_subscriber::fmt::layer()
        .log_internal_errors(false)
        .with_ansi(io::stderr().is_terminal() && !no_colour())
        .with_writer(io::stderr)
        .with_target(false)
        .without_time();
    tracing_subscriber::registry()
        .with(lines)
        .with(filter)
        .init();
}

/// Whether the user wants no colours: `NO_COLOR` is set and not empty (no-color.org).
fn no_colour() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}

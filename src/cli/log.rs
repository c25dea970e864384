//! Tracing to stderr, by `QUELL_LOG` or `-v`.

use std::io;
use tracing_subscriber::EnvFilter;

/// Starts the log: `QUELL_LOG` (a filter such as `quell=debug`) where it is set and can be read,
/// else warnings only, `-v` for what is done, `-vv` for details, `-vvv` for everything.
pub fn start(verbose: u8) {
    let level = match verbose {
        0 => "warn",
        1 => "info",
        2 => "debug",
        _ => "trace",
    };
    let filter = EnvFilter::try_from_env("QUELL_LOG").unwrap_or_else(|_| EnvFilter::new(level));
    // Where the log cannot be written (a full disk), its loss must not end what is logged: the subscriber would print
    // of its own failure, and panic where that fails, too.
    tracing_subscriber::fmt()
        .log_internal_errors(false)
        .with_env_filter(filter)
        .with_writer(io::stderr)
        .with_target(false)
        .without_time()
        .init();
}

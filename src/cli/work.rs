//! `quell work`: diagnoses the recordings in a queue.

#[cfg(feature = "nats")]
mod interrupts;

use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::available_parallelism;

use super::answers::told;
use super::{CliError, output, values};
use crate::batch::{Answer, Work, connect, work};

/// Diagnoses the recordings in a queue, one after the other, until it is told to end.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  quell work --queue nats://host:4222
  quell work --queue nats://host:4222 --jobs 1 --drain

Any number may work at one queue. At an interrupt it finishes what it has begun; at a second one it \
ends at once, and what it had begun is given to others. A recording that no worker survives is set \
aside after three, with that as its error.")]
pub struct Args {
    /// Address of the queue, as nats://host:4222.
    #[arg(long, value_name = "URL")]
    queue: String,
    /// Recordings at once [default: one a core].
    #[arg(long, value_name = "N", value_parser = values::count::<u16>)]
    jobs: Option<u16>,
    /// Ends when the queue is empty.
    #[arg(long)]
    drain: bool,
}

/// Runs the verb.
///
/// # Errors
/// [`CliError`] where the queue does not answer any more.
pub fn run(args: Args) -> Result<(), CliError> {
    let queue = connect(&args.queue).map_err(told)?;
    let cores = available_parallelism().map_or(1, usize::from);
    let at_once = args.jobs.map_or(cores, usize::from);
    let settings = Work {
        at_once,
        threads: cores / at_once,
        drain: args.drain,
    };
    let ending = Arc::new(AtomicBool::new(false));
    // Without NATS there is no queue, and this line is not reached.
    #[cfg(feature = "nats")]
    let _runtime = interrupts::watch(Arc::clone(&ending))?;
    work(&*queue, settings, &ending, &shown).map_err(told)
}

/// Prints a line for each answer; a closed output does not end the work.
fn shown(answer: &Answer) {
    let about = &answer.about;
    let verdict = answer.said("verdict").unwrap_or("set aside");
    let _ = output::text(&format!(
        "{} {verdict} {:.1} s\n",
        about.name, about.seconds
    ));
}

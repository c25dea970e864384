//! One diagnosis, on threads that give way to everything else.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::thread::available_parallelism;

use super::{Order, Report};
use crate::diagnosis::{Diagnosis, Options, Progress, diagnose};
use crate::recording::Recording;

/// The nicest that a thread can be: it gets what others leave.
const NICEST: i32 = 19;

/// What became of an order.
pub struct Diagnosed {
    /// What it says.
    pub diagnosis: Diagnosis,
    /// The page.
    pub report: String,
}

/// Does an order.
///
/// # Errors
/// A sentence where recording and model do not suit one another, or the work fails.
pub fn diagnosed(order: &Order, report: Report, progress: Progress) -> Result<Diagnosed, String> {
    // A robot must not stop because a recording is odd: what goes wrong in here is told, and no more.
    let work = AssertUnwindSafe(|| on_nice_threads(|| work(order, report, progress)));
    let broken = |_| "the diagnosis broke down; the log says where".to_string();
    catch_unwind(work).map_err(broken)??
}

fn work(order: &Order, report: Report, progress: Progress) -> Result<Diagnosed, String> {
    let recording = Recording::from_path(&order.path).map_err(|error| error.to_string())?;
    let options = Options::default();
    let outcome = diagnose(&order.model, &[recording], &[], &options, progress);
    let outcome = outcome.map_err(|error| error.to_string())?;
    let names = [order.recording.clone()];
    let page = report(
        &outcome.diagnosis,
        &outcome.traces,
        &order.model_name,
        &names,
    );
    Ok(Diagnosed {
        report: page.render(),
        diagnosis: outcome.diagnosis,
    })
}

/// Runs `work` in a pool of its own that leaves a core to the tick.
fn on_nice_threads<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, String> {
    let cores = available_parallelism().map_or(1, usize::from);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(cores.saturating_sub(1).max(1))
        .thread_name(|index| format!("quell-diagnosis-{index}"))
        .start_handler(|_| {
            // On Linux a priority is a thread's own; "none" is the one that asks.
            if let Err(error) = rustix::process::setpriority_process(None, NICEST) {
                tracing::warn!(%error, "a thread of the diagnosis keeps its usual priority");
            }
        });
    let pool = pool.build().map_err(|error| error.to_string())?;
    Ok(pool.install(work))
}

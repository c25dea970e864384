//! One diagnosis, on threads of lowest priority.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::available_parallelism;
use std::time::{Duration, Instant};

use super::{Order, Report};
use crate::diagnosis::{Diagnosis, DiagnosisError, Options, Progress, Stop, diagnose};
use crate::recording::Recording;

/// The lowest priority of a thread.
const NICEST: i32 = 19;

/// The outcome of an order.
pub struct Diagnosed {
    /// The diagnosis.
    pub diagnosis: Diagnosis,
    /// The page.
    pub report: String,
}

/// Why an order has no result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// It was cancelled.
    Cancelled,
    /// The reason as a sentence.
    Told(String),
}

/// Ends an order early: it was cancelled, or has taken too long.
#[derive(Clone)]
pub struct Stopper {
    cancelled: Arc<AtomicBool>,
    since: Instant,
    limit: Duration,
}

impl Stopper {
    /// For an order that begins now.
    pub fn new(limit: Duration) -> Self {
        Self {
            cancelled: Arc::default(),
            since: Instant::now(),
            limit,
        }
    }

    /// Cancels the order.
    pub fn cancel(&self) {
        self.cancelled.store(true, Relaxed);
    }

    fn asked(&self) -> bool {
        self.cancelled.load(Relaxed) || self.since.elapsed() >= self.limit
    }

    fn why(&self) -> Failure {
        if self.cancelled.load(Relaxed) {
            return Failure::Cancelled;
        }
        let limit = self.limit.as_secs_f64();
        let sentence = format!(
            "the diagnosis was given up: it was not done within {limit} s \
             (diagnosis.time_limit_s in the configuration)"
        );
        Failure::Told(sentence)
    }
}

/// Executes an order.
///
/// # Errors
/// [`Failure`] where recording and model do not match, the work fails, or is stopped.
pub fn diagnosed(
    order: &Order,
    report: Report,
    stop: &Stopper,
    progress: Progress,
) -> Result<Diagnosed, Failure> {
    // An odd recording must not stop the robot: a panic in here is reported, and no more.
    let work = AssertUnwindSafe(|| on_nice_threads(|| work(order, report, stop, progress)));
    let broken = |_| Failure::Told("the diagnosis broke down; the log says where".into());
    let done = catch_unwind(work).map_err(broken)??;
    // A cancelled job stays cancelled, even if its work was finished before it noticed.
    match stop.cancelled.load(Relaxed) {
        true => Err(Failure::Cancelled),
        false => done,
    }
}

fn work(
    order: &Order,
    report: Report,
    stop: &Stopper,
    progress: Progress,
) -> Result<Diagnosed, Failure> {
    let recording = Recording::from_path(&order.path).map_err(told)?;
    let asked = stop.clone();
    let options = Options {
        stop: Stop::when(move || asked.asked()),
        ..Options::default()
    };
    let outcome = diagnose(&order.model, &[recording], &[], &options, progress);
    let outcome = outcome.map_err(|error| match error {
        DiagnosisError::Stopped => stop.why(),
        error => told(error),
    })?;
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

fn told(error: impl std::fmt::Display) -> Failure {
    Failure::Told(error.to_string())
}

/// Runs `work` in a pool of its own that leaves one core to the tick.
fn on_nice_threads<T: Send>(work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let cores = available_parallelism().map_or(1, usize::from);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(cores.saturating_sub(1).max(1))
        .thread_name(|index| format!("quell-diagnosis-{index}"))
        .start_handler(|_| {
            // On Linux a priority belongs to a thread; `None` is the calling one.
            if let Err(error) = rustix::process::setpriority_process(None, NICEST) {
                tracing::warn!(%error, "a thread of the diagnosis keeps its usual priority");
            }
        });
    let pool = pool.build().map_err(told)?;
    Ok(pool.install(work))
}

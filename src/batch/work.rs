//! A worker: takes jobs, diagnoses, stores the answers, acknowledges.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use super::answer::{Answer, Done};
use super::error::BatchError;
use super::hash::hash;
use super::job::Job;
use super::queue::{Claim, Queue, Taken, Ticket};
use super::unpack::unpack;
use crate::diagnosis::{Options, diagnose};
use crate::model::Model;
use crate::recording::Recording;
use crate::report::page;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// How often a job is handed out at most. A machine that is switched off takes a job with it once; what has
/// taken three workers with it is no accident.
pub const MOST_DELIVERIES: u64 = 3;
/// Time between two signs of life, s: a third of what a queue waits for one.
pub(super) const HEARTBEAT: Duration = Duration::from_secs(5);

/// How to work.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    /// Jobs at once, at least 1. Two jobs on a core each are done sooner than one after the other on two: a
    /// diagnosis has parts that cannot be shared.
    pub at_once: usize,
    /// Threads of each job, at least 1.
    pub threads: usize,
    /// Whether to end when every job is acknowledged, instead of waiting for more.
    pub drain: bool,
}

/// The outcome of a job at a worker.
type Outcome = Result<Done, String>;

/// Works until `ending` is set, or there is nothing more to do; `told` hears of each answer.
///
/// Jobs that have begun are finished. A job that cannot be done gets its error as its answer.
///
/// # Errors
/// [`BatchError`] where the queue is lost, or the disk refuses; what was begun is then handed out to others.
pub fn work(
    queue: &dyn Queue,
    settings: Work,
    ending: &AtomicBool,
    told: &(dyn Fn(&Answer) + Sync),
) -> Result<(), BatchError> {
    let worker = || {
        let pool = ThreadPoolBuilder::new().num_threads(settings.threads.max(1));
        let pool = pool
            .build()
            .map_err(|error| BatchError::Thread(error.to_string()))?;
        let worker = Worker { queue, pool, told };
        let ended = worker.run(settings.drain, ending);
        if ended.is_err() {
            ending.store(true, Relaxed);
        }
        ended
    };
    std::thread::scope(|scope| {
        let workers = (0..settings.at_once.max(1)).map(|_| scope.spawn(worker));
        let workers: Vec<_> = workers.collect();
        let mut ended = Ok(());
        for worker in workers {
            let broken = |_| Err(BatchError::Thread("a worker broke down".into()));
            ended = ended.and(worker.join().unwrap_or_else(broken));
        }
        ended
    })
}

struct Worker<'a> {
    queue: &'a dyn Queue,
    pool: ThreadPool,
    told: &'a (dyn Fn(&Answer) + Sync),
}

impl Worker<'_> {
    fn run(&self, drain: bool, ending: &AtomicBool) -> Result<(), BatchError> {
        while !ending.load(Relaxed) {
            match self.queue.take()? {
                Taken::Job(claim) => self.one(claim)?,
                Taken::Nothing if drain && self.queue.left()? == 0 => break,
                Taken::Nothing => {}
                Taken::Ended => break,
            }
        }
        Ok(())
    }

    /// Does a job, once: stores the answer, then acknowledges.
    fn one(&self, claim: Claim) -> Result<(), BatchError> {
        let Claim {
            job,
            deliveries,
            ticket,
        } = claim;
        if self.queue.has_answer(&job.key)? {
            ticket.done();
            return Ok(());
        }
        let start = Instant::now();
        let outcome = if deliveries > MOST_DELIVERIES {
            Err(format!(
                "it was handed out {MOST_DELIVERIES} times, and no answer came: its workers died, or its \
                 recording did not arrive"
            ))
        } else {
            let Ok(packed) = ticket.recording() else {
                // It may have been dropped just now, by one who had the same job and was quicker.
                ticket.give_back();
                return Ok(());
            };
            alive(ticket.as_ref(), || self.outcome(&job, &packed))?
        };
        let answer = Answer::new(&job, start.elapsed().as_secs_f64(), outcome);
        if self.queue.store(&answer)? {
            (self.told)(&answer);
        }
        ticket.done();
        Ok(())
    }

    /// The answer to a recording, or the reason why there is none. An error is the worker's own.
    fn outcome(&self, job: &Job, packed: &[u8]) -> Result<Outcome, BatchError> {
        let found = hash(packed);
        if found != job.recording || !job.is_sound() {
            return Ok(Err(format!(
                "what came is not what was sent: its hash is {found}"
            )));
        }
        let scratch = tempfile::Builder::new().prefix("quell-").tempdir();
        let scratch = scratch.map_err(BatchError::disk(std::env::temp_dir()))?;
        let path = match unpack(packed, &job.entry, scratch.path()) {
            Err(BatchError::Archive(reason)) => return Ok(Err(reason)),
            path => path?,
        };
        // One recording that breaks the diagnosis must not end the batch.
        let work = AssertUnwindSafe(|| self.pool.install(|| diagnosed(job, &path)));
        let outcome = catch_unwind(work).unwrap_or_else(|_| Err("the diagnosis broke down".into()));
        // Where the worker has opened it says nothing to who reads the error.
        let place = format!("{}/", scratch.path().display());
        Ok(outcome.map_err(|error| error.replace(&place, "")))
    }
}

fn diagnosed(job: &Job, path: &Path) -> Outcome {
    let told = |error: &dyn std::error::Error| error.to_string();
    let recording = Recording::from_path(path).map_err(|error| told(&error))?;
    let model = Model::from_toml(&job.model, "model.toml").map_err(|error| told(&error))?;
    let options = Options {
        seed: job.seed,
        ..Options::default()
    };
    let outcome = diagnose(&model, &[recording], &[], &options, &|_, _| {});
    let outcome = outcome.map_err(|error| told(&error))?;
    let diagnosis = serde_json::to_value(&outcome.diagnosis).map_err(|error| told(&error))?;
    let names = [job.name.clone()];
    let page = page(&outcome.diagnosis, &outcome.traces, "model.toml", &names);
    Ok(Done {
        diagnosis,
        model: outcome.to_toml(),
        report: page.render(),
    })
}

/// Works, and says meanwhile that it does.
fn alive<T>(ticket: &dyn Ticket, work: impl FnOnce() -> T) -> T {
    let (done, ended) = channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(HEARTBEAT) {
                ticket.alive();
            }
        });
        let result = work();
        drop(done);
        result
    })
}

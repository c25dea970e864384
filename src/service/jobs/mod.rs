//! Diagnoses as jobs: one at a time, a few waiting, on threads of lowest priority.

mod job;
mod list;
mod work;

use std::path::PathBuf;
use std::sync::mpsc::{self, SyncSender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use thiserror::Error;

use crate::diagnosis::{Diagnosis, Traces};
use crate::model::Model;
use crate::page::Page;
pub use job::{Job, Status};
use list::List;

/// Most waiting jobs; a diagnosis takes a minute.
const WAITING: usize = 4;

/// Makes the report of a diagnosis, for a model and recordings of these names.
pub type Report = fn(&Diagnosis, &Traces, &str, &[String]) -> Page;

/// An order of a diagnosis.
#[derive(Clone)]
pub struct Order {
    /// Name of the recording.
    pub recording: String,
    /// Its folder.
    pub path: PathBuf,
    /// The believed model.
    pub model: Model,
    /// The model's name in the report.
    pub model_name: String,
}

/// The queue is full.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{WAITING} diagnoses wait already; try again when one is done")]
pub struct Full;

/// Why a job cannot be cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum CancelError {
    /// No such job, or it is no longer remembered.
    #[error("there is no diagnosis {id}, or no longer")]
    Unknown {
        /// The number asked for.
        id: u64,
    },
    /// It has already ended.
    #[error("diagnosis {id} has ended: it is {}", status.name())]
    Ended {
        /// The number asked for.
        id: u64,
        /// How it ended.
        status: Status,
    },
}

/// All jobs; cheap to clone. Their thread ends with the last clone.
#[derive(Clone, Debug)]
pub struct Jobs {
    list: Arc<Mutex<List>>,
    wake: SyncSender<()>,
}

impl Jobs {
    /// Starts the thread of the jobs, each for at most `limit`; `report` makes their reports.
    ///
    /// # Errors
    /// The system's error if it cannot create a thread.
    pub fn start(report: Report, limit: Duration) -> std::io::Result<Self> {
        // One pending wake-up is enough: the thread then does all waiting jobs.
        let (wake, woken) = mpsc::sync_channel(1);
        let list = Arc::new(Mutex::new(List::default()));
        let mine = Arc::clone(&list);
        let thread = std::thread::Builder::new().name("quell-diagnosis".into());
        thread.spawn(move || {
            while woken.recv().is_ok() {
                let next = || locked(&mine).begin(limit);
                while let Some(next) = next() {
                    let progress = |done: f64, what: &str| locked(&mine).tell(next.id, done, what);
                    let result = work::diagnosed(&next.order, report, &next.stop, &progress);
                    locked(&mine).end(next.id, result);
                }
            }
        })?;
        Ok(Self { list, wake })
    }

    /// Adds a job, and returns its state.
    ///
    /// # Errors
    /// [`Full`] where too many wait.
    pub fn add(&self, order: Order) -> Result<Job, Full> {
        let job = locked(&self.list).add(order)?;
        // If a wake-up is pending already, the thread will see this job, too.
        let _ = self.wake.try_send(());
        Ok(job)
    }

    /// Cancels a job: a waiting one at once, a running one within moments. A second cancel has no effect.
    ///
    /// # Errors
    /// [`CancelError`] where it cannot be cancelled.
    pub fn cancel(&self, id: u64) -> Result<Job, CancelError> {
        locked(&self.list).cancel(id)
    }

    /// The state of a job; `None` where it is unknown, or no longer remembered.
    pub fn job(&self, id: u64) -> Option<Job> {
        locked(&self.list).job(id).map(Job::now)
    }

    /// All that are remembered, oldest first, without their diagnoses.
    pub fn all(&self) -> Vec<Job> {
        locked(&self.list).jobs().map(Job::short).collect()
    }

    /// The report of a finished job.
    pub fn report(&self, id: u64) -> Option<Arc<str>> {
        locked(&self.list).job(id).and_then(Job::report)
    }
}

/// A panic cannot leave the list inconsistent: each change is a sequence of assignments of plain data.
fn locked(list: &Mutex<List>) -> MutexGuard<'_, List> {
    list.lock().unwrap_or_else(PoisonError::into_inner)
}

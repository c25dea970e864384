//! Diagnoses as jobs: one at a time, a few waiting, on threads that give way to everything else.

mod work;

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};
use std::time::Instant;

use serde::Serialize;
use thiserror::Error;

use crate::diagnosis::{Diagnosis, Traces};
use crate::model::Model;
use crate::report::Page;

/// Jobs that may wait; a diagnosis takes a minute, and nobody waits for longer than a few.
const WAITING: usize = 4;
/// Jobs that are remembered with their reports, of some hundred kilobytes each.
const REMEMBERED: usize = 32;

/// Makes the report of a diagnosis, for a model and recordings of these names.
pub type Report = fn(&Diagnosis, &Traces, &str, &[String]) -> Page;

/// What is to be diagnosed.
#[derive(Clone)]
pub struct Order {
    /// Name of the recording.
    pub recording: String,
    /// Its folder.
    pub path: PathBuf,
    /// What is believed of the machine.
    pub model: Model,
    /// What the report calls the model.
    pub model_name: String,
}

/// Where a job stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Others are before it.
    Waiting,
    /// It is at work.
    Running,
    /// There is a verdict.
    Done,
    /// There will be none.
    Failed,
}

/// A job as the outside sees it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Job {
    /// Its number, counted up.
    pub id: u64,
    /// Name of the recording.
    pub recording: String,
    /// Where it stands.
    pub status: Status,
    /// The share of the work that is done, 0 to 1.
    pub progress: f64,
    /// What is being done.
    pub doing: String,
    /// How long it has worked, s.
    pub seconds: f64,
    /// Why it failed.
    pub error: Option<String>,
    /// What it says.
    pub diagnosis: Option<Diagnosis>,
    #[serde(skip)]
    report: Option<Arc<str>>,
    #[serde(skip)]
    since: Option<Instant>,
}

/// No room for one more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("{WAITING} diagnoses wait already; try again when one is done")]
pub struct Full;

/// All jobs; cheap to clone. The thread that does them ends when the last clone goes.
#[derive(Clone, Debug)]
pub struct Jobs {
    list: Arc<Mutex<List>>,
    orders: mpsc::Sender<(u64, Order)>,
}

#[derive(Debug, Default)]
struct List {
    last: u64,
    jobs: VecDeque<Job>,
}

impl Jobs {
    /// Starts the thread that does them, which makes reports by `report`.
    ///
    /// # Errors
    /// What the system says where it makes no thread.
    pub fn start(report: Report) -> std::io::Result<Self> {
        let (orders, ordered) = mpsc::channel();
        let list = Arc::new(Mutex::new(List::default()));
        let mine = Arc::clone(&list);
        let thread = std::thread::Builder::new().name("quell-diagnosis".into());
        thread.spawn(move || {
            while let Ok((id, order)) = ordered.recv() {
                let progress = |done: f64, what: &str| {
                    change(&mine, id, |job| {
                        (job.progress, job.doing) = (done.clamp(0.0, 1.0), what.into());
                    });
                };
                change(&mine, id, |job| {
                    (job.status, job.since) = (Status::Running, Some(Instant::now()));
                });
                let result = work::diagnosed(&order, report, &progress);
                change(&mine, id, |job| job.finish(result));
            }
        })?;
        Ok(Self { list, orders })
    }

    /// Adds a job, and says how it stands.
    ///
    /// # Errors
    /// [`Full`] where too many wait.
    pub fn add(&self, order: Order) -> Result<Job, Full> {
        let mut list = locked(&self.list);
        let waiting = |job: &&Job| job.status == Status::Waiting;
        if list.jobs.iter().filter(waiting).count() >= WAITING {
            return Err(Full);
        }
        list.last += 1;
        let job = Job {
            id: list.last,
            recording: order.recording.clone(),
            status: Status::Waiting,
            progress: 0.0,
            doing: "waiting".into(),
            seconds: 0.0,
            error: None,
            diagnosis: None,
            report: None,
            since: None,
        };
        list.jobs.push_back(job.clone());
        if list.jobs.len() > REMEMBERED {
            list.jobs.pop_front();
        }
        // The thread lives as long as this sender.
        self.orders.send((job.id, order)).map_err(|_| Full)?;
        Ok(job)
    }

    /// How a job stands; none where it is not known, or no longer.
    pub fn job(&self, id: u64) -> Option<Job> {
        let list = locked(&self.list);
        list.jobs.iter().find(|job| job.id == id).map(Job::now)
    }

    /// All that are remembered, oldest first, without what they say.
    pub fn all(&self) -> Vec<Job> {
        let short = |job: &Job| Job {
            diagnosis: None,
            report: None,
            ..job.now()
        };
        locked(&self.list).jobs.iter().map(short).collect()
    }

    /// The report of a job that is done.
    pub fn report(&self, id: u64) -> Option<Arc<str>> {
        self.job(id).and_then(|job| job.report)
    }
}

impl Job {
    fn now(&self) -> Self {
        let since = self.since.map(|since| since.elapsed().as_secs_f64());
        Self {
            seconds: since.unwrap_or(self.seconds),
            ..self.clone()
        }
    }

    fn finish(&mut self, result: Result<work::Diagnosed, String>) {
        self.seconds = self.now().seconds;
        self.since = None;
        match result {
            Ok(done) => {
                (self.status, self.progress) = (Status::Done, 1.0);
                self.doing = "done".into();
                self.report = Some(done.report.into());
                self.diagnosis = Some(done.diagnosis);
            }
            Err(error) => {
                self.status = Status::Failed;
                self.doing = "failed".into();
                self.error = Some(error);
            }
        }
    }
}

/// No holder can leave the list half changed: each change is one assignment after another of plain data.
fn locked(list: &Mutex<List>) -> MutexGuard<'_, List> {
    list.lock().unwrap_or_else(PoisonError::into_inner)
}

fn change(list: &Mutex<List>, id: u64, change: impl FnOnce(&mut Job)) {
    if let Some(job) = locked(list).jobs.iter_mut().find(|job| job.id == id) {
        change(job);
    }
}

//! The remembered jobs, and the waiting orders.

use std::collections::VecDeque;
use std::time::Duration;

use super::job::{Job, Status};
use super::work::{Diagnosed, Failure, Stopper};
use super::{CancelError, Full, Order, WAITING};

/// Jobs that are remembered with their reports of some hundred kilobytes each.
const REMEMBERED: usize = 32;

/// All jobs. An order is kept as long as its job waits, a stopper as long as it runs.
#[derive(Default)]
pub struct List {
    last: u64,
    jobs: VecDeque<Job>,
    orders: VecDeque<(u64, Order)>,
    running: Option<(u64, Stopper)>,
}

/// A job that begins.
pub struct Begun {
    /// Its number.
    pub id: u64,
    /// The order.
    pub order: Order,
    /// Ends it early.
    pub stop: Stopper,
}

impl std::fmt::Debug for List {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_list().entries(&self.jobs).finish()
    }
}

impl List {
    /// Adds a job that waits.
    ///
    /// # Errors
    /// [`Full`] where too many wait.
    pub fn add(&mut self, order: Order) -> Result<Job, Full> {
        if self.orders.len() >= WAITING {
            return Err(Full);
        }
        self.last += 1;
        let job = Job::new(self.last, order.recording.clone());
        self.orders.push_back((job.id, order));
        self.jobs.push_back(job.clone());
        if self.jobs.len() > REMEMBERED {
            let ended = self.jobs.iter().position(|job| job.status.has_ended());
            ended.and_then(|oldest| self.jobs.remove(oldest));
        }
        Ok(job)
    }

    /// Begins the next job, for at most `limit`.
    pub fn begin(&mut self, limit: Duration) -> Option<Begun> {
        let (id, order) = self.orders.pop_front()?;
        let stop = Stopper::new(limit);
        self.running = Some((id, stop.clone()));
        self.change(id, |job| job.begin(limit.as_secs_f64()));
        Some(Begun { id, order, stop })
    }

    /// Updates the progress of a job.
    pub fn tell(&mut self, id: u64, done: f64, what: &str) {
        self.change(id, |job| {
            (job.progress, job.doing) = (done.clamp(0.0, 1.0), what.into());
        });
    }

    /// Notes the outcome of a job.
    pub fn end(&mut self, id: u64, result: Result<Diagnosed, Failure>) {
        self.running = None;
        self.change(id, |job| job.finish(result));
    }

    /// Cancels a job.
    ///
    /// # Errors
    /// [`CancelError`] where it cannot be cancelled.
    pub fn cancel(&mut self, id: u64) -> Result<Job, CancelError> {
        let status = self.job(id).map(|job| job.status);
        match status.ok_or(CancelError::Unknown { id })? {
            Status::Waiting => {
                self.orders.retain(|(waiting, _)| *waiting != id);
                self.change(id, Job::cancel);
            }
            Status::Running => {
                let own = self.running.iter().filter(|(running, _)| *running == id);
                own.for_each(|(_, stop)| stop.cancel());
                self.change(id, |job| job.doing = "being cancelled".into());
            }
            Status::Cancelled => {}
            status @ (Status::Done | Status::Failed) => {
                return Err(CancelError::Ended { id, status });
            }
        }
        self.job(id)
            .map(Job::now)
            .ok_or(CancelError::Unknown { id })
    }

    /// A job, if it is remembered.
    pub fn job(&self, id: u64) -> Option<&Job> {
        self.jobs.iter().find(|job| job.id == id)
    }

    /// All that are remembered, oldest first.
    pub fn jobs(&self) -> impl Iterator<Item = &Job> {
        self.jobs.iter()
    }

    fn change(&mut self, id: u64, change: impl FnOnce(&mut Job)) {
        if let Some(job) = self.jobs.iter_mut().find(|job| job.id == id) {
            change(job);
        }
    }
}

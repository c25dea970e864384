//! A queue of jobs.

use std::borrow::Cow;

use super::answer::Answer;
use super::error::BatchError;
use super::job::Job;
use super::packed::Packed;

/// Takes jobs in, hands them out, and keeps the answers.
///
/// A job that was handed out and not acknowledged is handed out again, so that it may be done twice; its
/// answer is kept once.
pub trait Queue: Sync {
    /// Puts a job in, unless it is there or has its answer; waits where there is no room.
    ///
    /// # Errors
    /// [`BatchError`] where the queue does not take it.
    fn submit(&self, job: &Job, packed: Packed) -> Result<Submitted, BatchError>;

    /// Takes a job out, and waits a few seconds for one.
    ///
    /// # Errors
    /// [`BatchError`] where the queue is no more; what passes is not told.
    fn take(&self) -> Result<Taken, BatchError>;

    /// Whether a job has its answer.
    ///
    /// # Errors
    /// [`BatchError`] where the queue does not say.
    fn has_answer(&self, key: &str) -> Result<bool, BatchError>;

    /// Keeps the answer to a job, and says whether it is the first.
    ///
    /// # Errors
    /// [`BatchError`] where it cannot be kept.
    fn store(&self, answer: &Answer) -> Result<bool, BatchError>;

    /// Jobs that have not been acknowledged.
    ///
    /// # Errors
    /// [`BatchError`] where the queue does not say.
    fn left(&self) -> Result<u64, BatchError>;

    /// Tells every answer, one after the other.
    ///
    /// # Errors
    /// [`BatchError`] where the queue does not tell them, or `each` fails.
    fn answers(
        &self,
        each: &mut dyn FnMut(Answer) -> Result<(), BatchError>,
    ) -> Result<(), BatchError>;
}

/// The outcome of putting a job in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Submitted {
    /// It waits now.
    Queued,
    /// It was there already.
    Waiting,
    /// It had its answer already.
    Answered,
}

/// An item of a queue.
pub enum Taken {
    /// A job.
    Job(Claim),
    /// None just now.
    Nothing,
    /// None any more.
    Ended,
}

/// A job that was handed out.
pub struct Claim {
    /// The job.
    pub job: Job,
    /// How often it was handed out, this time counted.
    pub deliveries: u64,
    /// The answer that goes back to the queue.
    pub ticket: Box<dyn Ticket>,
}

/// The messages of a job's holder to the queue.
pub trait Ticket: Send + Sync {
    /// The packed recording.
    ///
    /// # Errors
    /// [`BatchError`] where it is not to be had.
    fn recording(&self) -> Result<Cow<'_, [u8]>, BatchError>;

    /// Says that the job is being worked at.
    fn alive(&self);

    /// Acknowledges the job, whose answer is stored, and drops its recording. Where the queue does not hear
    /// it, the job is handed out again, and found to have its answer.
    fn done(self: Box<Self>);

    /// Gives the job back undone.
    fn give_back(self: Box<Self>);
}

//! The queue of one process: a few jobs in memory, and the answers in a folder.

use std::borrow::Cow;
use std::collections::{HashSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use super::answer::Answer;
use super::error::BatchError;
use super::folder::{self, Folder};
use super::job::Job;
use super::packed::Packed;
use super::queue::{Claim, Queue, Submitted, Taken, Ticket};

/// How long a worker waits for a job before it looks whether it should end.
const PATIENCE: Duration = Duration::from_secs(1);

/// A queue in memory. Who puts in more than there is room for waits, so that a batch of any length takes
/// the memory of a few recordings.
pub struct InProcess {
    folder: Folder,
    room: usize,
    shared: Arc<Shared>,
}

#[derive(Default)]
struct Shared {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    waiting: VecDeque<Waiting>,
    /// Keys of what was put in and not acknowledged.
    held: HashSet<String>,
    closed: bool,
}

struct Waiting {
    job: Job,
    packed: Vec<u8>,
    deliveries: u64,
}

impl InProcess {
    /// A queue with room for so many jobs that wait, at least one, with answers in a folder.
    pub fn new(folder: Folder, room: usize) -> Self {
        Self {
            folder,
            room: room.max(1),
            shared: Arc::default(),
        }
    }

    /// Nothing more is put in: who waits for a job learns that there is none.
    pub fn close(&self) {
        self.shared.state().closed = true;
        self.shared.changed.notify_all();
    }

    /// The answers.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }
}

impl Shared {
    /// No holder can leave the state half changed: each change is one assignment after another of plain data.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        let waited = self.changed.wait_timeout(state, PATIENCE);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

impl Queue for InProcess {
    fn submit(&self, job: &Job, packed: Packed) -> Result<Submitted, BatchError> {
        let mut state = self.shared.state();
        while state.waiting.len() >= self.room && !state.closed {
            state = self.shared.wait(state);
        }
        if state.closed {
            return Err(BatchError::Closed);
        }
        if self.folder.has(&job.key) {
            return Ok(Submitted::Answered);
        }
        if !state.held.insert(job.key.clone()) {
            return Ok(Submitted::Waiting);
        }
        state.waiting.push_back(Waiting {
            job: job.clone(),
            packed: packed.bytes,
            deliveries: 0,
        });
        self.shared.changed.notify_all();
        Ok(Submitted::Queued)
    }

    fn take(&self) -> Result<Taken, BatchError> {
        let mut state = self.shared.state();
        if state.waiting.is_empty() && !state.closed {
            state = self.shared.wait(state);
        }
        let Some(mut one) = state.waiting.pop_front() else {
            return Ok(match state.closed {
                true => Taken::Ended,
                false => Taken::Nothing,
            });
        };
        self.shared.changed.notify_all();
        one.deliveries += 1;
        Ok(Taken::Job(Claim {
            job: one.job.clone(),
            deliveries: one.deliveries,
            ticket: Box::new(Held {
                one,
                shared: Arc::clone(&self.shared),
            }),
        }))
    }

    fn has_answer(&self, key: &str) -> Result<bool, BatchError> {
        Ok(self.folder.has(key))
    }

    fn store(&self, answer: &Answer) -> Result<bool, BatchError> {
        self.folder.store(answer)
    }

    fn left(&self) -> Result<u64, BatchError> {
        Ok(self.shared.state().held.len() as u64)
    }

    fn answers(
        &self,
        each: &mut dyn FnMut(Answer) -> Result<(), BatchError>,
    ) -> Result<(), BatchError> {
        let folders = self.folder.folders();
        folders.iter().try_for_each(|one| each(folder::read(one)?))
    }
}

/// A job that was handed out.
struct Held {
    one: Waiting,
    shared: Arc<Shared>,
}

impl Ticket for Held {
    fn recording(&self) -> Result<Cow<'_, [u8]>, BatchError> {
        Ok(Cow::Borrowed(&self.one.packed))
    }

    fn alive(&self) {}

    fn done(self: Box<Self>) {
        self.shared.state().held.remove(&self.one.job.key);
    }

    fn give_back(self: Box<Self>) {
        let Self { one, shared } = *self;
        shared.state().waiting.push_back(one);
        shared.changed.notify_all();
    }
}

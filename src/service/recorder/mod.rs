//! The recorder: listens to the stream and puts each move, or what is asked for, onto the shelf.

mod demand;
mod journal;
mod known;
mod log;
mod running;
mod shelf;
mod task;

use std::sync::Arc;

use thiserror::Error;
use tokio::sync::{mpsc, oneshot};

use super::contract::Handle;
use demand::Demand;
pub use shelf::{About, Archive, Bounds, Draft, Entry, Shelf, ShelfError, name_of_move};
use task::Task;

/// The whole as one file in the profile of ROS 2, beside manifest and CSV.
const MCAP: &str = "recording.mcap";
/// Requests that may wait.
const REQUESTS: usize = 8;

/// Why nothing is recorded on demand.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RecordError {
    /// One runs already.
    #[error("{joint} is being recorded already")]
    Running {
        /// The joint.
        joint: String,
    },
    /// None runs.
    #[error("nothing is being recorded on demand")]
    NotRunning,
    /// The disk refuses it, or what was recorded is no recording.
    #[error("the recording {name} is not kept: {reason}")]
    NotKept {
        /// Its name.
        name: String,
        /// Why.
        reason: String,
    },
    /// The recorder has ended.
    #[error("the recorder has ended")]
    Gone,
}

/// The outside's end of the recorder; cheap to clone.
#[derive(Clone, Debug)]
pub struct Recorder {
    shelf: Arc<Shelf>,
    requests: mpsc::Sender<Demand>,
}

impl Recorder {
    /// Starts to listen, as long as the runtime lives.
    pub fn start(handle: &Handle, shelf: impl Into<Arc<Shelf>>) -> Self {
        let shelf = shelf.into();
        let (requests, requested) = mpsc::channel(REQUESTS);
        let task = Task::new(handle.clone(), Arc::clone(&shelf));
        // From here on nothing is missed, whenever the task begins.
        tokio::spawn(task.run(handle.stream(), requested));
        Self { shelf, requests }
    }

    /// The shelf of the recordings.
    pub fn shelf(&self) -> &Arc<Shelf> {
        &self.shelf
    }

    /// Records a joint from now on until [`Recorder::end`], five minutes at most; returns the name.
    ///
    /// # Errors
    /// [`RecordError`] where one is recorded already, or the disk refuses.
    pub async fn begin(&self, joint: &str, index: usize) -> Result<String, RecordError> {
        let joint = joint.to_owned();
        self.ask(|reply| Demand::Begin {
            joint,
            index,
            reply,
        })
        .await
    }

    /// Ends what [`Recorder::begin`] began; returns the name that it has on the shelf.
    ///
    /// # Errors
    /// [`RecordError`] where nothing is recorded on demand, or the disk refuses.
    pub async fn end(&self) -> Result<String, RecordError> {
        self.ask(|reply| Demand::End { reply }).await
    }

    /// Puts onto the shelf what is being recorded, and ends. For after the engine's end: what the
    /// stream still holds is taken first.
    pub async fn close(&self) {
        let (reply, closed) = oneshot::channel();
        if self.requests.send(Demand::Close { reply }).await.is_ok() {
            // It has ended, one way or another.
            let _ = closed.await;
        }
    }

    async fn ask(
        &self,
        demand: impl FnOnce(oneshot::Sender<Result<String, RecordError>>) -> Demand,
    ) -> Result<String, RecordError> {
        let (reply, answer) = oneshot::channel();
        let sent = self.requests.send(demand(reply)).await;
        sent.map_err(|_| RecordError::Gone)?;
        answer.await.unwrap_or(Err(RecordError::Gone))
    }
}

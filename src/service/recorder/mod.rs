//! The recorder: reads the stream and stores each move, and recordings on demand, on the shelf.

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
pub use shelf::{
    About, Archive, Bounds, Draft, Entry, RecordingEnd, Shelf, ShelfError, name_of_move,
};
use task::Task;

/// The whole recording as one file in the profile of ROS 2, besides manifest and CSV.
const MCAP: &str = "recording.mcap";
/// Most waiting requests.
const REQUESTS: usize = 8;

/// Why a recording on demand fails.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RecordError {
    /// One is running already.
    #[error("{joint} is being recorded already")]
    Running {
        /// The joint.
        joint: String,
    },
    /// None is running.
    #[error("nothing is being recorded on demand")]
    NotRunning,
    /// The disk refuses it, or its data are no valid recording.
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

/// A handle to the recorder; cheap to clone.
#[derive(Clone, Debug)]
pub struct Recorder {
    shelf: Arc<Shelf>,
    requests: mpsc::Sender<Demand>,
}

impl Recorder {
    /// Starts to read the stream, as long as the runtime lives.
    pub fn start(handle: &Handle, shelf: impl Into<Arc<Shelf>>) -> Self {
        let shelf = shelf.into();
        let (requests, requested) = mpsc::channel(REQUESTS);
        let task = Task::new(handle.clone(), Arc::clone(&shelf));
        // Subscribed here, so that nothing is missed, whenever the task begins.
        tokio::spawn(task.run(handle.stream(), requested));
        Self { shelf, requests }
    }

    /// The shelf of the recordings.
    pub fn shelf(&self) -> &Arc<Shelf> {
        &self.shelf
    }

    /// Records a joint from now on until [`Recorder::end`], at most five minutes; returns the name.
    ///
    /// # Errors
    /// [`RecordError`] where a recording on demand is running, or the disk refuses.
    pub async fn begin(&self, joint: &str, index: usize) -> Result<String, RecordError> {
        let joint = joint.to_owned();
        self.ask(|reply| Demand::Begin {
            joint,
            index,
            reply,
        })
        .await
    }

    /// Ends the recording of [`Recorder::begin`]; returns its name on the shelf.
    ///
    /// # Errors
    /// [`RecordError`] where no recording on demand is running, or the disk refuses.
    pub async fn end(&self) -> Result<String, RecordError> {
        self.ask(|reply| Demand::End { reply }).await
    }

    /// Stores running recordings on the shelf, and ends. To be called after the engine's end: the rest of the
    /// stream is read first.
    pub async fn close(&self) {
        let (reply, closed) = oneshot::channel();
        if self.requests.send(Demand::Close { reply }).await.is_ok() {
            // It has ended in any case.
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

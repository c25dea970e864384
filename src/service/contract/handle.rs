//! The ends of the channels between engine and outside.

use std::sync::Arc;

use tokio::sync::{broadcast, mpsc, oneshot, watch};

use super::{Accepted, Batch, RecordingNews, Request, ServiceError, Snapshot};

/// Requests that may wait; one more is refused at once.
const REQUESTS: usize = 64;
/// Of these, so many are kept for stops.
const KEPT_FOR_STOP: usize = 8;
/// Batches that a slow reader may be behind, some 10 s; then it loses the oldest.
const BATCHES: usize = 512;

/// A request and where its answer goes.
#[derive(Debug)]
pub struct Envelope {
    /// What is asked for.
    pub request: Request,
    /// Where the answer goes.
    pub reply: oneshot::Sender<Result<Accepted, ServiceError>>,
}

/// What the outside holds of the engine; cheap to clone.
#[derive(Clone, Debug)]
pub struct Handle {
    requests: mpsc::Sender<Envelope>,
    snapshot: watch::Receiver<Arc<Snapshot>>,
    stream: broadcast::Sender<Arc<Batch>>,
    recordings: mpsc::UnboundedSender<RecordingNews>,
}

/// What the engine holds of the outside.
#[derive(Debug)]
pub struct EngineEnds {
    /// What is asked for.
    pub requests: mpsc::Receiver<Envelope>,
    /// Where the state of everything is published.
    pub snapshot: watch::Sender<Arc<Snapshot>>,
    /// Where batches go; nobody need listen.
    pub stream: broadcast::Sender<Arc<Batch>>,
    /// What becomes of recordings: a few words a move.
    pub recordings: mpsc::UnboundedReceiver<RecordingNews>,
}

/// Both ends, for the engine or for one that stands in for it in a test.
pub fn channels(first: Snapshot) -> (Handle, EngineEnds) {
    let (requests, requested) = mpsc::channel(REQUESTS);
    let (publish, snapshot) = watch::channel(Arc::new(first));
    let (stream, _) = broadcast::channel(BATCHES);
    let (tell, recordings) = mpsc::unbounded_channel();
    let ends = EngineEnds {
        requests: requested,
        snapshot: publish,
        stream: stream.clone(),
        recordings,
    };
    let handle = Handle {
        requests,
        snapshot,
        stream,
        recordings: tell,
    };
    (handle, ends)
}

impl Handle {
    /// Asks for something and waits for the answer: some milliseconds, at a correction up to a second.
    ///
    /// # Errors
    /// [`ServiceError`] where it is refused; [`ServiceError::Busy`] where too many requests wait.
    pub async fn ask(&self, request: Request) -> Result<Accepted, ServiceError> {
        let needed = match request {
            Request::Stop => 1,
            _ => 1 + KEPT_FOR_STOP,
        };
        if self.requests.capacity() < needed && !self.requests.is_closed() {
            return Err(ServiceError::Busy);
        }
        let (reply, answer) = oneshot::channel();
        let envelope = Envelope { request, reply };
        self.requests
            .try_send(envelope)
            .map_err(|error| match error {
                mpsc::error::TrySendError::Full(_) => ServiceError::Busy,
                mpsc::error::TrySendError::Closed(_) => ServiceError::Gone,
            })?;
        answer.await.unwrap_or(Err(ServiceError::Gone))
    }

    /// The state of everything as last published.
    pub fn snapshot(&self) -> Arc<Snapshot> {
        Arc::clone(&self.snapshot.borrow())
    }

    /// Wakes up whenever the state is published anew.
    pub fn snapshots(&self) -> watch::Receiver<Arc<Snapshot>> {
        self.snapshot.clone()
    }

    /// Says what became of a recording.
    pub fn tell(&self, news: RecordingNews) {
        // An engine that has ended shows no state any more.
        let _ = self.recordings.send(news);
    }

    /// The stream from now on.
    pub fn stream(&self) -> broadcast::Receiver<Arc<Batch>> {
        self.stream.subscribe()
    }
}

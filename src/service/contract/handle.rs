//! The ends of the channels between engine and outside.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::SeqCst};

use tokio::sync::{broadcast, mpsc, oneshot, watch};

use super::{Accepted, Batch, RecordingNews, Request, ServiceError, Snapshot};

/// Most waiting stops, and most waiting requests of all other kinds; further ones are refused at once.
const REQUESTS: usize = 64;
/// Batches that a slow reader may lag behind, some 10 s; then it loses the oldest.
const BATCHES: usize = 512;

/// A request with the channel for its answer.
#[derive(Debug)]
pub struct Envelope {
    /// The request.
    pub request: Request,
    /// Number of requests before it.
    pub number: u64,
    /// Where the answer goes.
    pub reply: oneshot::Sender<Result<Accepted, ServiceError>>,
}

/// The clients' end of the engine; cheap to clone.
#[derive(Clone, Debug)]
pub struct Handle {
    stops: mpsc::Sender<Envelope>,
    others: mpsc::Sender<Envelope>,
    count: Arc<AtomicU64>,
    snapshot: watch::Receiver<Arc<Snapshot>>,
    stream: broadcast::Sender<Arc<Batch>>,
    recordings: mpsc::UnboundedSender<RecordingNews>,
}

/// The engine's end of the channels to the clients.
#[derive(Debug)]
pub struct EngineEnds {
    /// The requests, in order of arrival.
    pub requests: Requests,
    /// Where the state of everything is published.
    pub snapshot: watch::Sender<Arc<Snapshot>>,
    /// Receives the batches; a reader is optional.
    pub stream: broadcast::Sender<Arc<Batch>>,
    /// The outcomes of recordings: a short message for each move.
    pub recordings: mpsc::UnboundedReceiver<RecordingNews>,
}

/// The queue of requests as the engine reads it: a stop comes first. A request from before a stop has a lower
/// number than the stop, though it is read after it.
#[derive(Debug)]
pub struct Requests {
    stops: mpsc::Receiver<Envelope>,
    others: mpsc::Receiver<Envelope>,
}

impl Requests {
    /// Waits for the next request; `None` once no client is left. A cancelled wait loses none.
    pub async fn recv(&mut self) -> Option<Envelope> {
        tokio::select! {
            biased;
            Some(stop) = self.stops.recv() => Some(stop),
            other = self.others.recv() => other,
        }
    }

    /// The next request, if one is waiting.
    pub fn try_recv(&mut self) -> Option<Envelope> {
        let stop = self.stops.try_recv();
        stop.or_else(|_| self.others.try_recv()).ok()
    }
}

/// Both ends, for the engine or for a stand-in in a test.
pub fn channels(first: Snapshot) -> (Handle, EngineEnds) {
    let (stops, stops_asked) = mpsc::channel(REQUESTS);
    let (others, others_asked) = mpsc::channel(REQUESTS);
    let (publish, snapshot) = watch::channel(Arc::new(first));
    let (stream, _) = broadcast::channel(BATCHES);
    let (tell, recordings) = mpsc::unbounded_channel();
    let ends = EngineEnds {
        requests: Requests {
            stops: stops_asked,
            others: others_asked,
        },
        snapshot: publish,
        stream: stream.clone(),
        recordings,
    };
    let handle = Handle {
        stops,
        others,
        count: Arc::default(),
        snapshot,
        stream,
        recordings: tell,
    };
    (handle, ends)
}

impl Handle {
    /// Sends a request and waits for the answer: some milliseconds, during a correction up to a second.
    ///
    /// # Errors
    /// [`ServiceError`] where it is refused; [`ServiceError::Busy`] where too many requests wait.
    pub async fn ask(&self, request: Request) -> Result<Accepted, ServiceError> {
        let (reply, answer) = oneshot::channel();
        let lane = match request {
            Request::Stop | Request::Disable => &self.stops,
            _ => &self.others,
        };
        let envelope = Envelope {
            request,
            number: self.count.fetch_add(1, SeqCst),
            reply,
        };
        lane.try_send(envelope).map_err(|error| match error {
            mpsc::error::TrySendError::Full(_) => ServiceError::Busy,
            mpsc::error::TrySendError::Closed(_) => ServiceError::Gone,
        })?;
        answer.await.unwrap_or(Err(ServiceError::Gone))
    }

    /// The last published state.
    pub fn snapshot(&self) -> Arc<Snapshot> {
        Arc::clone(&self.snapshot.borrow())
    }

    /// A receiver that wakes up at each new state.
    pub fn snapshots(&self) -> watch::Receiver<Arc<Snapshot>> {
        self.snapshot.clone()
    }

    /// Reports the outcome of a recording.
    pub fn tell(&self, news: RecordingNews) {
        // An engine that has ended shows no state.
        let _ = self.recordings.send(news);
    }

    /// The stream from now on.
    pub fn stream(&self) -> broadcast::Receiver<Arc<Batch>> {
        self.stream.subscribe()
    }
}

//! Requests to the recorder.

use tokio::sync::oneshot;

use super::RecordError;

/// A request to the recorder.
#[derive(Debug)]
pub enum Demand {
    /// A recording of a joint, until it is ended.
    Begin {
        /// The joint.
        joint: String,
        /// Its number, counted from 0.
        index: usize,
        /// Channel for the name.
        reply: oneshot::Sender<Result<String, RecordError>>,
    },
    /// The end of it.
    End {
        /// Channel for the name.
        reply: oneshot::Sender<Result<String, RecordError>>,
    },
    /// The end of the recorder.
    Close {
        /// Notified when everything is on the shelf.
        reply: oneshot::Sender<()>,
    },
}

//! The demands on the recorder.

use tokio::sync::oneshot;

use super::RecordError;

/// A demand on the recorder.
#[derive(Debug)]
pub enum Demand {
    /// A recording of a joint, until it is ended.
    Begin {
        /// The joint.
        joint: String,
        /// Its number, counted from 0.
        index: usize,
        /// Where the name goes.
        reply: oneshot::Sender<Result<String, RecordError>>,
    },
    /// The end of it.
    End {
        /// Where the name goes.
        reply: oneshot::Sender<Result<String, RecordError>>,
    },
    /// The end of the recorder.
    Close {
        /// Told when all is on the shelf.
        reply: oneshot::Sender<()>,
    },
}

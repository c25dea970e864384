//! The contract between engine and clients: requests, state, stream.
//!
//! Plain data at the boundary, so that every name carries its unit. A client holds a [`Handle`]. Neither the
//! client nor the tick waits for the other: the state is the last published one, and a reader of the stream
//! that is too slow loses batches and is told how many.

mod disk;
mod enabling;
mod error;
mod handle;
mod modes;
mod recording;
mod request;
mod snapshot;
mod stream;

pub use disk::{DiskFault, DiskPart, DiskState, DiskView};
pub use enabling::{EnableState, EnableView, FaultKind};
pub use error::{ErrorKind, ServiceError};
pub use handle::{EngineEnds, Envelope, Handle, Requests, channels};
pub use modes::{JointMap, KnownMode, LearningView, MapMove, MapPoint, ModeMap};
pub use recording::RecordingNews;
pub use request::{Accepted, Begun, ModeValue, Request, ShapingChange, Stopping, Target};
pub use snapshot::{
    EstimateView, JointSnapshot, LinkHealth, MoveEnd, MoveResult, Phase, SensorView, Snapshot,
    TickStatistics, TrainView, WatchdogState,
};
pub use stream::{Batch, Event, Frame, Measured, MoveStart, Quantity, TickRow};

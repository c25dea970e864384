//! Queues of optional features; of each there is a stand-in for builds without it.

use super::error::BatchError;
use super::queue::Queue;

/// The queue at an address, as `nats://host:4222`.
///
/// # Errors
/// [`BatchError`] where nothing answers there, or the queue is not part of this build.
#[cfg(feature = "nats")]
pub fn connect(address: &str) -> Result<Box<dyn Queue>, BatchError> {
    Ok(Box::new(super::nats::Nats::connect(address)?))
}

/// There is none in this build.
///
/// # Errors
/// [`BatchError::NotBuilt`], always.
#[cfg(not(feature = "nats"))]
pub fn connect(_: &str) -> Result<Box<dyn Queue>, BatchError> {
    Err(BatchError::NotBuilt { feature: "nats" })
}

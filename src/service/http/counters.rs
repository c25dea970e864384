//! Counters of the HTTP interface.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use axum::http::StatusCode;

/// Statuses that are counted separately; others are counted by their class.
const STATUSES: [u16; 14] = [
    400, 401, 403, 404, 405, 408, 409, 413, 415, 422, 426, 500, 503, 507,
];

/// Counts since the start.
#[derive(Debug, Default)]
pub struct Counters {
    /// Requests answered.
    pub requests: AtomicU64,
    refused: [AtomicU64; STATUSES.len()],
    /// Connections open now.
    pub connections: AtomicU64,
    /// Connections refused because too many were open.
    pub connections_refused: AtomicU64,
    /// WebSockets open now.
    pub streams: AtomicU64,
    /// WebSockets closed because the client did not read.
    pub streams_closed: AtomicU64,
    /// Batches that slow readers lost.
    pub batches_lost: AtomicU64,
}

/// Counts one open item as long as this lives.
pub struct Open<'a>(&'a AtomicU64);

impl<'a> Open<'a> {
    /// One more.
    pub fn new(count: &'a AtomicU64) -> Self {
        count.fetch_add(1, Relaxed);
        Self(count)
    }
}

impl Drop for Open<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Relaxed);
    }
}

impl Counters {
    /// Counts an answer.
    pub fn answered(&self, status: StatusCode) {
        add(&self.requests);
        if status.is_client_error() || status.is_server_error() {
            let class = if status.is_server_error() { 500 } else { 400 };
            let place = |code: u16| STATUSES.iter().position(|&known| known == code);
            if let Some(index) = place(status.as_u16()).or_else(|| place(class)) {
                add(&self.refused[index]);
            }
        }
    }

    /// Requests refused, by status.
    pub fn refused(&self) -> impl Iterator<Item = (u16, u64)> {
        let counts = self.refused.iter().map(|count| count.load(Relaxed));
        STATUSES.into_iter().zip(counts)
    }
}

/// Counts one.
pub fn add(count: &AtomicU64) {
    count.fetch_add(1, Relaxed);
}

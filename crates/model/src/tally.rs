//! Count of simulations, as a measure of a diagnosis' work.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

static MADE: AtomicU64 = AtomicU64::new(0);

pub(super) fn count() {
    MADE.fetch_add(1, Relaxed);
}

/// Simulations of an experiment that this process has made so far, all threads together.
pub fn simulations() -> u64 {
    MADE.load(Relaxed)
}

//! Signals that end the work.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use tokio::runtime::{Builder, Runtime};
use tokio::signal::unix::{Signal, SignalKind, signal};

/// Sets `ending` at the first signal, as long as the returned runtime is kept.
///
/// # Errors
/// If the system has no thread or no signal left.
pub fn watch(ending: Arc<AtomicBool>) -> std::io::Result<Runtime> {
    let runtime = Builder::new_multi_thread()
        .worker_threads(1)
        .enable_all()
        .build()?;
    let guard = runtime.enter();
    let interrupts = [
        signal(SignalKind::interrupt())?,
        signal(SignalKind::terminate())?,
    ];
    drop(guard);
    runtime.spawn(interrupted(interrupts, ending));
    Ok(runtime)
}

/// Sets `ending` at the first signal, and ends the process at the second.
async fn interrupted([mut interrupt, mut terminate]: [Signal; 2], ending: Arc<AtomicBool>) {
    for last in [false, true] {
        tokio::select! {
            _ = interrupt.recv() => {}
            _ = terminate.recv() => {}
        }
        if last {
            std::process::exit(1);
        }
        tracing::warn!("finishing what is begun; a second interrupt ends at once");
        ending.store(true, Relaxed);
    }
}

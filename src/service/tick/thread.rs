//! The thread of the tick.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;

use super::{Pulse, real_time};

/// Settings of the tick's thread.
#[derive(Clone, Copy, Debug)]
pub struct TickThreadSettings {
    /// Whether a real-time priority and locked memory are asked for.
    pub real_time: bool,
}

/// The thread of the tick; it ends when this is dropped.
pub struct TickThread {
    ending: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl TickThread {
    /// Starts it.
    ///
    /// # Errors
    /// The system's error.
    pub fn start(pulse: Pulse, settings: TickThreadSettings) -> io::Result<Self> {
        let ending = Arc::new(AtomicBool::new(false));
        let stop = Arc::clone(&ending);
        let thread = std::thread::Builder::new()
            .name("quell-tick".into())
            .spawn(move || keep(pulse, settings, &stop))?;
        Ok(Self {
            ending,
            thread: Some(thread),
        })
    }

    /// Whether it has ended, which it never does on its own.
    pub fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl Drop for TickThread {
    fn drop(&mut self) {
        self.ending.store(true, Relaxed);
        if let Some(thread) = self.thread.take() {
            // If it panicked, that was reported when it did.
            let _ = thread.join();
        }
    }
}

fn keep(mut pulse: Pulse, settings: TickThreadSettings, ending: &AtomicBool) {
    let raised = settings.real_time && real_time::raise_priority();
    let locked = settings.real_time && real_time::lock_memory();
    pulse.begin(raised, locked);
    while !ending.load(Relaxed) {
        pulse.beat();
    }
}

//! Long work on a thread of its own, while the caller's thread obeys Ctrl-C and tells how far it is.

use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::Builder;
use std::time::Duration;

/// Time between two looks at signals and progress: a person sees no delay, and the work none either.
const LOOK: Duration = Duration::from_millis(50);

/// What the work and the thread that waits for it share.
#[derive(Clone, Default)]
pub struct Watch(Arc<Shared>);

#[derive(Default)]
struct Shared {
    /// Whether the work shall end.
    stop: AtomicBool,
    /// The share that is done, and what is being done.
    done: Mutex<(f64, String)>,
}

impl Watch {
    /// Whether the work shall end.
    pub fn stops(&self) -> bool {
        self.0.stop.load(Relaxed)
    }

    /// Says how far the work is.
    pub fn tell(&self, share: f64, what: &str) {
        *self.0.done.lock().unwrap_or_else(PoisonError::into_inner) = (share, what.into());
    }

    fn told(&self) -> (f64, String) {
        let done = self.0.done.lock();
        done.unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// Does the work on a thread of its own, without the interpreter's lock.
///
/// On Ctrl-C the work is told to end and its result is thrown away; it is not waited for.
///
/// * `progress`: called with the share that is done, 0 to 1, and what is being done.
///
/// # Errors
/// What a handler of signals or `progress` raises, such as `KeyboardInterrupt`.
pub fn wait<T: Send + 'static>(
    py: Python<'_>,
    watch: &Watch,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    let (send, mut receive) = channel();
    let work = move || {
        // Nobody listens any more after Ctrl-C.
        let _ = send.send(work());
    };
    let thread = Builder::new().name("quell".into()).spawn(work)?;
    let mut last = (-1.0, String::new());
    loop {
        let waited = py.detach(move || (receive.recv_timeout(LOOK), receive));
        receive = waited.1;
        match waited.0 {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => {
                    return Err(PyErr::new::<pyo3::exceptions::PyRuntimeError, _>(
                        "no result",
                    ));
                }
            },
            Err(RecvTimeoutError::Timeout) => {}
        }
        let now = watch.told();
        let told = match progress.filter(|_| now != last) {
            Some(progress) => progress.call1((now.0, &now.1)).map(drop),
            None => Ok(()),
        };
        if let Err(error) = py.check_signals().and(told) {
            watch.0.stop.store(true, Relaxed);
            return Err(error);
        }
        last = now;
    }
}

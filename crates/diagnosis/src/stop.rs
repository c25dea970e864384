//! Ending a diagnosis before its time.

use super::error::DiagnosisError;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Says whether a diagnosis shall end before its time; cheap to clone.
///
/// It is asked before each simulation. Once the answer is yes nothing is simulated any more: a simulation
/// that was left out is taken for one that ran away, so that every fit turns back at once, and what comes
/// of the search is thrown away. So the answer stays yes, whatever is said later.
#[derive(Clone, Default)]
pub struct Stop(Option<Arc<Asked>>);

struct Asked {
    ask: Box<dyn Fn() -> bool + Send + Sync>,
    /// Whether it ever said yes.
    said: AtomicBool,
}

impl Stop {
    /// As soon as `ask` says so; it is asked often, and on many threads.
    pub fn when(ask: impl Fn() -> bool + Send + Sync + 'static) -> Self {
        let said = AtomicBool::new(false);
        let ask = Box::new(ask);
        Self(Some(Arc::new(Asked { ask, said })))
    }

    /// Asks now.
    pub(super) fn now(&self) -> bool {
        self.0.as_ref().is_some_and(|asked| {
            let stops = asked.said.load(Relaxed) || (asked.ask)();
            if stops {
                asked.said.store(true, Relaxed);
            }
            stops
        })
    }

    /// Asks now.
    ///
    /// # Errors
    /// [`DiagnosisError::Stopped`] where the answer is or was yes.
    pub(super) fn check(&self) -> Result<(), DiagnosisError> {
        match self.now() {
            true => Err(DiagnosisError::Stopped),
            false => Ok(()),
        }
    }

    /// Whether the answer was ever yes, so that something may have been left out.
    pub(super) fn was_asked(&self) -> bool {
        let said = |asked: &Arc<Asked>| asked.said.load(Relaxed);
        self.0.as_ref().is_some_and(said)
    }
}

impl std::fmt::Debug for Stop {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let said = self.was_asked();
        formatter.debug_struct("Stop").field("said", &said).finish()
    }
}

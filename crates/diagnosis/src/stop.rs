//! Early end of a diagnosis.

use super::error::DiagnosisError;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// A request to end a diagnosis early; cheap to clone.
///
/// It is asked before each simulation. After the first yes nothing is simulated any more: a skipped simulation
/// looks like one that diverged, so that every fit turns back at once, and the result of the search is
/// discarded. So the answer stays yes, whatever `ask` returns later.
#[derive(Clone, Default)]
pub struct Stop(Option<Arc<Asked>>);

struct Asked {
    ask: Box<dyn Fn() -> bool + Send + Sync>,
    /// Whether it was ever yes.
    said: AtomicBool,
}

impl Stop {
    /// Stops as soon as `ask` returns true. It is called often, and on many threads.
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

    /// Stops where this one or the other does.
    pub(super) fn or(&self, other: &Self) -> Self {
        let both = [self.clone(), other.clone()];
        Self::when(move || both.iter().any(Self::now))
    }

    /// Whether the answer was ever yes, so that a simulation may have been skipped.
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

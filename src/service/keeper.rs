//! Saves states to a disk that may refuse them for a while.

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use super::clock::ServiceClock;
use super::state::{State, StateFile};

/// Interval of retries after a failed write.
const AGAIN: Duration = Duration::from_secs(1);

/// Saves states, always the newest. A failed write is repeated every second.
pub struct Keeper {
    file: StateFile,
    states: Receiver<State>,
    clock: ServiceClock,
    /// A state that could not be written yet.
    unsaved: Option<State>,
    /// Time of the last failed write, s.
    refused: f64,
}

impl Keeper {
    /// A keeper that has saved nothing yet.
    pub fn new(file: StateFile, states: Receiver<State>, clock: ServiceClock) -> Self {
        Self {
            file,
            states,
            clock,
            unsaved: None,
            refused: f64::NEG_INFINITY,
        }
    }

    /// Saves arriving states until the sender is gone; an unsaved state is then tried once more.
    pub fn run(mut self) {
        loop {
            let next = match self.unsaved {
                None => self.states.recv().map_err(RecvTimeoutError::from),
                Some(_) => self.states.recv_timeout(AGAIN),
            };
            match next {
                Ok(state) => self.keep(state),
                Err(RecvTimeoutError::Timeout) => self.work(),
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        if let Some(state) = self.unsaved
            && let Err(error) = self.file.save(&state)
        {
            tracing::error!(%error, "the service ends, and its last state is not kept");
        }
    }

    /// One pass of [`Keeper::run`], without waiting.
    pub fn work(&mut self) {
        if let Ok(state) = self.states.try_recv() {
            return self.keep(state);
        }
        let waited = self.clock.now() - self.refused >= AGAIN.as_secs_f64();
        if let Some(state) = self.unsaved.take_if(|_| waited) {
            self.keep(state);
        }
    }

    fn keep(&mut self, state: State) {
        let newest = self.states.try_iter().last().unwrap_or(state);
        // The disk keeps its own error.
        let refused = self.file.save(&newest).is_err();
        self.unsaved = refused.then_some(newest);
        if refused {
            self.refused = self.clock.now();
        }
    }
}

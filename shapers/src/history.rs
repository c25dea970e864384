//! What a filter was given and what it has sent.

use crate::Buffer;
use crate::complex::Complex;
use crate::modal_state::ModalState;

/// One tick of the past, as an adaptive filter remembers it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Entry {
    planned: f64,
    sent: f64,
    /// Whether the output was constant: nothing sent before can be half of a move.
    settled: bool,
}

/// A ring of positions planned and sent, one entry a tick.
#[derive(Clone, Debug)]
pub(crate) struct History<E> {
    ring: E,
    next: usize,
    count: usize,
    /// Whether entries have been overwritten.
    overwritten: bool,
}

/// The vibration that positions planned and sent leave, referred to the newest tick.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Vibration {
    pub planned: ModalState,
    pub sent: ModalState,
}

/// Fewest ticks of the past that are a past: an increment needs two.
pub(crate) const SHORTEST_HISTORY: usize = 2;

impl<E: Buffer<Entry>> History<E> {
    /// At rest at position 0; the ring holds at least [`SHORTEST_HISTORY`] ticks.
    pub fn new(ring: E) -> Self {
        let mut history = Self {
            ring,
            next: 0,
            count: 0,
            overwritten: false,
        };
        history.reset(0.0);
        history
    }

    /// Forgets everything: at rest at `position`, not vibrating.
    pub fn reset(&mut self, position: f64) {
        (self.next, self.count, self.overwritten) = (0, 0, false);
        self.push(position, position, true);
    }

    pub fn push(&mut self, planned: f64, sent: f64, settled: bool) {
        self.ring[self.next] = Entry {
            planned,
            sent,
            settled,
        };
        self.next = if self.next + 1 == self.ring.len() {
            0
        } else {
            self.next + 1
        };
        if self.count < self.ring.len() {
            self.count += 1;
        } else {
            self.overwritten = true;
        }
    }

    /// The modal states at the newest tick of everything kept.
    ///
    /// `None` where the ring has lost the start of a move that it still holds the end of.
    pub fn vibration(&self, pole: Complex) -> Option<Vibration> {
        let oldest = if self.count < self.ring.len() {
            0
        } else {
            self.next
        };
        let entry = |k: usize| {
            let index = oldest + k;
            &self.ring[if index < self.ring.len() {
                index
            } else {
                index - self.ring.len()
            }]
        };
        let start = if self.overwritten {
            (0..self.count).find(|&k| entry(k).settled)?
        } else {
            0
        };
        let turn = pole.exp();
        let mut vibration = Vibration::default();
        for k in start + 1..self.count {
            let (before, now) = (entry(k - 1), entry(k));
            vibration.planned.tick(turn, now.planned - before.planned);
            vibration.sent.tick(turn, now.sent - before.sent);
        }
        Some(vibration)
    }
}

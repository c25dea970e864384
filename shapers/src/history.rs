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
    /// Ticks without an increment, this one the last of them.
    still: u32,
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

/// Ticks after which nothing is left of an increment: `exp(-50)` times an age of a hundred thousand ticks
/// is below the rounding of what is newer.
fn remembered(pole: Complex) -> usize {
    match 50.0 / -pole.re {
        ticks if ticks.is_finite() && ticks > 0.0 => ticks as usize + 1,
        _ => usize::MAX,
    }
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
        let newest = match self.next {
            0 => self.ring.len() - 1,
            next => next - 1,
        };
        let last = self.ring[newest];
        let rests = self.count > 0 && last.planned == planned && last.sent == sent;
        self.ring[self.next] = Entry {
            planned,
            sent,
            settled,
            still: if rests {
                last.still.saturating_add(1)
            } else {
                0
            },
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
        let (mut weight, mut age, mut k) = (Complex::ONE, 0, self.count - 1);
        while k > start && age < remembered(pole) {
            // At rest a command adds nothing: such ticks are passed over at once.
            let still = (entry(k).still as usize).min(k - start);
            if still > 0 {
                weight = weight * pole.scale(still as f64).exp();
            } else {
                let (before, now) = (entry(k - 1), entry(k));
                let term = |increment: f64| weight.scale(increment);
                let (planned, sent) = (
                    term(now.planned - before.planned),
                    term(now.sent - before.sent),
                );
                vibration.planned.add(planned, age as f64);
                vibration.sent.add(sent, age as f64);
                weight = weight * turn;
            }
            age += still.max(1);
            k -= still.max(1);
        }
        Some(vibration)
    }
}

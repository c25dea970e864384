//! The past of a filter: its input and its output.

use crate::Buffer;
use crate::modal_state::ModalState;
use num_complex::Complex64;

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

/// The weights `exp(lambda age)` of increments, from the newest on.
struct Weight {
    pole: Complex64,
    /// Of one tick.
    turn: Complex64,
    age: usize,
    value: Complex64,
}

impl Weight {
    fn new(pole: Complex64) -> Self {
        Self {
            pole,
            turn: pole.exp(),
            age: 0,
            value: Complex64::ONE,
        }
    }

    /// The weight of an age that is not below the last one.
    #[inline]
    fn at(&mut self, age: usize) -> Complex64 {
        match age - self.age {
            0 => {}
            1 => self.value *= self.turn,
            ticks => self.value *= self.pole.scale(ticks as f64).exp(),
        }
        self.age = age;
        self.value
    }
}

/// Time constants after which nothing is left of an increment: `exp(-37)` is below the rounding of what is newer.
const VALUE: f64 = 37.0;
/// The same of its slope, times an age of a hundred thousand ticks.
const SLOPE: f64 = 50.0;

/// So many time constants in ticks.
fn remembered(pole: Complex64, constants: f64) -> usize {
    match constants / -pole.re {
        ticks if ticks.is_finite() && ticks > 0.0 => (ticks as usize).saturating_add(1),
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

    /// Becomes a copy of another one with a ring of the same length.
    pub fn copy_from(&mut self, other: &Self) {
        let used = match other.overwritten {
            true => other.ring.len(),
            false => other.count,
        };
        self.ring[..used].copy_from_slice(&other.ring[..used]);
        (self.next, self.count, self.overwritten) = (other.next, other.count, other.overwritten);
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

    /// The vibration at the newest tick of everything planned, and of everything sent.
    ///
    /// `None` where the ring has lost the start of a move that it still holds the end of.
    pub fn left(&self, pole: Complex64) -> Option<[Complex64; 2]> {
        let mut weight = Weight::new(pole);
        let mut left = [Complex64::default(); 2];
        self.increments(remembered(pole, VALUE), |age, increments| {
            let weight = weight.at(age);
            for (left, increment) in left.iter_mut().zip(increments) {
                *left += weight.scale(increment);
            }
        })?;
        Some(left)
    }

    /// The modal states at the newest tick of everything planned and of everything sent; `None` as for
    /// [`History::left`].
    pub fn states(&self, pole: Complex64) -> Option<[ModalState; 2]> {
        let mut weight = Weight::new(pole);
        let mut states = [ModalState::default(); 2];
        self.increments(remembered(pole, SLOPE), |age, increments| {
            let weight = weight.at(age);
            for (state, increment) in states.iter_mut().zip(increments) {
                state.add(weight.scale(increment), age as f64);
            }
        })?;
        Some(states)
    }

    /// Ages and increments of what was planned and sent, from the newest on, as far back as it matters. At rest
    /// a command adds nothing: such ticks are passed over at once.
    fn increments(&self, remembered: usize, mut each: impl FnMut(usize, [f64; 2])) -> Option<()> {
        let past = self.past()?.min(remembered);
        let (mut place, mut age) = (self.back_from(self.next, 1), 0);
        let mut entry = self.ring[place];
        while age < past {
            let still = (entry.still as usize).min(past - age);
            if still > 0 {
                place = self.back_from(place, still);
                entry = self.ring[place];
                age += still;
                continue;
            }
            place = self.back_from(place, 1);
            let before = self.ring[place];
            each(
                age,
                [entry.planned - before.planned, entry.sent - before.sent],
            );
            entry = before;
            age += 1;
        }
        Some(())
    }

    /// Increments since the oldest entry from which the whole of a move is kept.
    fn past(&self) -> Option<usize> {
        if !self.overwritten {
            return Some(self.count - 1);
        }
        let (newer, older) = self.ring.split_at(self.next);
        let start = older.iter().chain(newer).position(|entry| entry.settled)?;
        Some(self.count - 1 - start)
    }

    /// The place of what came so many ticks before that at `index`.
    #[inline]
    fn back_from(&self, index: usize, ticks: usize) -> usize {
        match index.checked_sub(ticks) {
            Some(place) => place,
            None => index + self.ring.len() - ticks,
        }
    }
}

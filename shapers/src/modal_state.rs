//! The vibration that increments of a command leave of a mode, and how that changes with the mode.

use crate::GridTrain;
use num_complex::Complex64;

/// `value = sum du_k exp(lambda tau_k)` and its derivative by `lambda`, times in ticks:
/// `slope = sum tau_k du_k exp(lambda tau_k)`, where `tau_k` is the age of the increment and
/// `lambda = (-xi omega + j omega_d) T_s`.
///
/// The derivative is complex, so that where it vanishes the value is insensitive to errors of
/// frequency and of damping alike.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ModalState {
    pub value: Complex64,
    pub slope: Complex64,
}

impl ModalState {
    /// Later by ticks (or earlier, if negative).
    pub fn later(self, pole: Complex64, ticks: f64) -> Self {
        self.turned(pole.scale(ticks).exp(), ticks)
    }

    /// Later by ticks, `turn = exp(lambda ticks)`.
    #[inline]
    pub fn turned(self, turn: Complex64, ticks: f64) -> Self {
        Self {
            value: self.value * turn,
            slope: (self.slope + self.value.scale(ticks)) * turn,
        }
    }

    /// An increment more, `term = du exp(lambda tau)`, of age `tau` in ticks.
    #[inline]
    pub fn add(&mut self, term: Complex64, age: f64) {
        self.value += term;
        self.slope += term.scale(age);
    }

    /// State left, referred to now, by positions at the ticks after now.
    pub fn of_future(pole: Complex64, now: f64, positions: impl Iterator<Item = f64>) -> Self {
        let turn = (-pole).exp();
        let (mut before, mut weight, mut ticks) = (now, Complex64::ONE, 0.0);
        let mut state = Self::default();
        for position in positions {
            weight *= turn;
            ticks += 1.0;
            let term = weight.scale(position - before);
            state.value += term;
            state.slope -= term.scale(ticks);
            before = position;
        }
        state
    }

    /// The vibration after a train: the product with `sum A_i exp(-lambda d_i)`, `d_i` in ticks.
    pub fn shaped(self, train: &GridTrain, pole: Complex64) -> Self {
        let mut factor = Self::default();
        for tap in train.taps() {
            let delay = -f64::from(tap.delay);
            factor.add(pole.scale(delay).exp().scale(tap.amplitude), delay);
        }
        Self {
            value: self.value * factor.value,
            slope: self.value * factor.slope + self.slope * factor.value,
        }
    }

    pub fn scaled(self, factor: f64) -> Self {
        Self {
            value: self.value.scale(factor),
            slope: self.slope.scale(factor),
        }
    }

    pub fn less(self, other: Self) -> Self {
        self.sum(other.scaled(-1.0))
    }

    #[inline]
    pub fn sum(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
        }
    }
}

//! What increments of a command leave of a mode, and how that changes with the mode.

use crate::complex::Complex;
use crate::{Mode, Setpoint};

/// `value = sum du_k exp(lambda tau_k)` and its derivative by `lambda`, times in ticks:
/// `slope = sum tau_k du_k exp(lambda tau_k)`, where `tau_k` is the age of the increment and
/// `lambda = (-xi omega + j omega_d) T_s`.
///
/// The derivative is complex, so that where it vanishes the value is insensitive to errors of
/// frequency and of damping alike.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ModalState {
    pub value: Complex,
    pub slope: Complex,
}

impl ModalState {
    /// Later by ticks (or earlier, if negative).
    pub fn later(self, pole: Complex, ticks: f64) -> Self {
        self.turned(pole.scale(ticks).exp(), ticks)
    }

    /// Later by ticks, `turn = exp(lambda ticks)`.
    #[inline]
    pub fn turned(self, turn: Complex, ticks: f64) -> Self {
        Self {
            value: self.value * turn,
            slope: (self.slope + self.value.scale(ticks)) * turn,
        }
    }

    /// An increment more, `term = du exp(lambda tau)`, of age `tau` in ticks.
    #[inline]
    pub fn add(&mut self, term: Complex, age: f64) {
        self.value = self.value + term;
        self.slope = self.slope + term.scale(age);
    }

    /// `value` alone of [`ModalState::of_future`].
    pub fn value_of_future(
        pole: Complex,
        now: f64,
        positions: impl Iterator<Item = f64>,
    ) -> Complex {
        let turn = pole.scale(-1.0).exp();
        let (mut before, mut weight) = (now, Complex::ONE);
        let mut value = Complex::default();
        for position in positions {
            weight = weight * turn;
            value = value + weight.scale(position - before);
            before = position;
        }
        value
    }

    /// State left, referred to now, by positions at the ticks after now.
    pub fn of_future(pole: Complex, now: f64, positions: impl Iterator<Item = f64>) -> Self {
        let turn = pole.scale(-1.0).exp();
        let (mut before, mut weight, mut ticks) = (now, Complex::ONE, 0.0);
        let mut state = Self::default();
        for position in positions {
            weight = weight * turn;
            ticks += 1.0;
            let term = weight.scale(position - before);
            state.value = state.value + term;
            state.slope = state.slope - term.scale(ticks);
            before = position;
        }
        state
    }

    pub fn sum(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
        }
    }
}

/// `lambda = (-xi omega + j omega_d) T_s`.
pub(crate) fn pole(mode: Mode, sample_time: f64) -> Complex {
    Complex::new(-mode.decay_rate(), mode.damped_frequency()).scale(sample_time)
}

/// [`ModalState::of_future`] of setpoints.
pub(crate) fn of_future(pole: Complex, now: f64, future: &[Setpoint]) -> ModalState {
    ModalState::of_future(pole, now, future.iter().map(|setpoint| setpoint.position))
}

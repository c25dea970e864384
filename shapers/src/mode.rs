//! A vibratory mode: the only place where hertz become radians per second.

use core::f64::consts::TAU;
use num_traits::Float;

/// One damped mode of vibration, `s^2 + 2 xi omega_n s + omega_n^2`.
///
/// * `omega_n`, natural frequency, rad/s, finite and above 0;
/// * `xi`, damping ratio, 0 <= xi < 1 (an overdamped mode does not ring and needs no shaper).
///
/// # Example
/// ```
/// use quell_shapers::Mode;
/// let mode = Mode::from_hertz(8.12, 0.084).unwrap();
/// assert!((mode.damped_frequency() / mode.natural_frequency() - 0.996466).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    natural_frequency: f64,
    damping_ratio: f64,
}

/// Why two numbers are not a mode; carries the number.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ModeError {
    /// The natural frequency is not a finite number above zero (rad/s).
    #[error("natural frequency {0} rad/s is not a finite number above 0")]
    NaturalFrequency(f64),
    /// The damping ratio is outside `[0, 1)`.
    #[error("damping ratio {0} is not in [0, 1)")]
    DampingRatio(f64),
}

impl Mode {
    /// A mode from its natural frequency in rad/s and its damping ratio.
    ///
    /// # Errors
    /// [`ModeError`] where a value is not finite or out of its range.
    pub fn new(natural_frequency: f64, damping_ratio: f64) -> Result<Self, ModeError> {
        if !(natural_frequency.is_finite() && natural_frequency > 0.0) {
            return Err(ModeError::NaturalFrequency(natural_frequency));
        }
        if !(0.0..1.0).contains(&damping_ratio) {
            return Err(ModeError::DampingRatio(damping_ratio));
        }
        Ok(Self {
            natural_frequency,
            damping_ratio,
        })
    }

    /// A mode from its natural frequency `f_n = omega_n / 2 pi` in hertz and its damping ratio.
    ///
    /// # Errors
    /// As [`Mode::new`].
    pub fn from_hertz(frequency: f64, damping_ratio: f64) -> Result<Self, ModeError> {
        Self::new(frequency * TAU, damping_ratio)
    }

    /// `omega_n`, rad/s.
    pub fn natural_frequency(&self) -> f64 {
        self.natural_frequency
    }

    /// `f_n = omega_n / 2 pi`, Hz.
    pub fn hertz(&self) -> f64 {
        self.natural_frequency / TAU
    }

    /// `xi`, dimensionless.
    pub fn damping_ratio(&self) -> f64 {
        self.damping_ratio
    }

    /// `omega_d = omega_n sqrt(1 - xi^2)`, rad/s.
    pub fn damped_frequency(&self) -> f64 {
        self.natural_frequency * Float::sqrt(1.0 - self.damping_ratio * self.damping_ratio)
    }

    /// `xi omega_n`, the rate at which the envelope decays, 1/s.
    pub fn decay_rate(&self) -> f64 {
        self.damping_ratio * self.natural_frequency
    }

    /// `T_d = 2 pi / omega_d`, s.
    pub fn damped_period(&self) -> f64 {
        TAU / self.damped_frequency()
    }
}

//! The pole of a mode, and how well it is known.

use crate::{Mode, UncertainMode};
use num_complex::Complex64;
use num_traits::Float;

/// `mu = -xi + j sqrt(1 - xi^2)`: the pole of a mode over its natural frequency.
pub(crate) fn unit_pole(damping_ratio: f64) -> Complex64 {
    let imaginary = Float::sqrt(1.0 - damping_ratio * damping_ratio);
    Complex64::new(-damping_ratio, imaginary)
}

/// Real part of `conj(a) b`.
#[inline]
pub(crate) fn dot(a: Complex64, b: Complex64) -> f64 {
    (a.conj() * b).re
}

/// `lambda = (-xi omega + j omega_d) T_s`.
pub(crate) fn pole(mode: Mode, sample_time: f64) -> Complex64 {
    Complex64::new(-mode.decay_rate(), mode.damped_frequency()).scale(sample_time)
}

/// Variance of [`pole`]: `|d lambda / d omega| = 1`, `|d lambda / d xi| = omega / sqrt(1 - xi^2)`, times `T_s`.
pub(crate) fn pole_variance(known: &UncertainMode, sample_time: f64) -> f64 {
    let mode = known.mode;
    let root = mode.damped_frequency() / mode.natural_frequency();
    let along = mode.natural_frequency() * known.damping_ratio_std / root;
    let across = known.natural_frequency_std;
    (across * across + along * along) * sample_time * sample_time
}

//! Estimators of a vibratory mode, on-line, sample by sample.

use quell_shapers::Mode;

/// One aligned sample of the axis, on the sensor's stamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub time: f64,
    /// Motor-side position `u`, rad.
    pub motor_position: f64,
    /// `delta = y - u`, link position minus motor-side position, rad.
    pub deformation: f64,
}

/// What an estimator believes after its last sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Time of the last sample used, s.
    pub time: f64,
    /// `omega_n` and `xi`.
    pub mode: Mode,
    /// One standard deviation of `omega_n`, rad/s.
    pub natural_frequency_std: f64,
    /// One standard deviation of `xi`.
    pub damping_ratio_std: f64,
    /// Static gain `K`, dimensionless.
    pub gain: f64,
    /// One standard deviation of `K`.
    pub gain_std: f64,
    /// Whether the estimate has settled (see the estimator's convergence rule).
    pub converged: bool,
}

/// A method that learns a mode from a stream of samples.
///
/// `observe` runs at the tick: it does not allocate, block or fail; a sample that is not finite or
/// does not advance in time is ignored.
pub trait Estimator: Send {
    /// Takes one sample.
    fn observe(&mut self, sample: Sample);
    /// The present estimate, once there is one.
    fn estimate(&self) -> Option<Estimate>;
    /// Forgets every sample, to begin a new window.
    fn restart(&mut self);
}

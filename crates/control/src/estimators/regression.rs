//! From the unknowns of eq. (4) to an estimate that converges and is then frozen.

use quell_shapers::Mode;

use super::convergence::Convergence;
use super::{Estimate, Settings};

/// The estimate of a linear regression. It is frozen once converged: later the vibration sinks into the noise
/// while the regressors' noise goes on adding up, and the estimate would drift away. If the integrals restart
/// after each `memory` of the settings, this does not happen, and the estimate continues.
/// goes on.
#[derive(Clone, Copy, Debug)]
pub struct Settling {
    range: (f64, f64),
    keeps: bool,
    convergence: Convergence,
    estimate: Option<Estimate>,
}

impl Settling {
    /// Nothing estimated yet.
    pub fn new(settings: &Settings) -> Self {
        Self {
            range: settings.frequency_range,
            keeps: settings.memory.is_infinite(),
            convergence: Convergence::default(),
            estimate: None,
        }
    }

    /// Takes `alpha_1 = w^2`, `alpha_2 = 2 xi w` and a gain.
    ///
    /// Solutions that are no vibratory mode in the frequency range are skipped.
    pub fn push(&mut self, time: f64, stiffness: f64, damping: f64, gain: f64) {
        let w = stiffness.sqrt();
        if !(w >= self.range.0 && w <= self.range.1) {
            return;
        }
        let Ok(mode) = Mode::new(w, (0.5 * damping / w).max(0.0)) else {
            return;
        };
        self.convergence.push(time, w, 0.5 * damping / w);
        let [log_std, damping_ratio_std] = self
            .convergence
            .spread()
            .unwrap_or([f64::INFINITY, f64::INFINITY]);
        self.estimate = Some(Estimate {
            time,
            mode,
            natural_frequency_std: log_std * w,
            damping_ratio_std,
            gain,
            gain_std: log_std * gain.abs(),
            converged: self.convergence.settled(),
        });
    }

    /// The present estimate.
    pub fn estimate(&self) -> Option<Estimate> {
        self.estimate
    }

    /// Whether the estimate has converged and is frozen.
    pub fn is_frozen(&self) -> bool {
        self.keeps && self.estimate.is_some_and(|estimate| estimate.converged)
    }

    /// Discards all estimates.
    pub fn restart(&mut self) {
        self.convergence = Convergence::default();
        self.estimate = None;
    }
}

/// Ratio of the deformation's variance to that of its noise above which it counts as vibrating.
///
/// Noise that makes up a tenth of a regression's columns biases the unknowns by as much, and a regression on
/// noise alone has a solution, too.
const HEARD: f64 = 10.0;

/// Detects a vibration in noise, sample by sample.
///
/// Third differences remove what is smooth and leave 20 times the variance of white noise
/// (1 + 9 + 9 + 1).
#[derive(Clone, Copy, Debug, Default)]
pub struct Hearing {
    last: [f64; 3],
    count: f64,
    origin: f64,
    sum: f64,
    square: f64,
    rough: f64,
}

impl Hearing {
    /// Takes a deformation.
    pub fn push(&mut self, deformation: f64) {
        if self.count == 0.0 {
            self.origin = deformation;
        }
        let [a, b, c] = self.last;
        if self.count >= 3.0 {
            self.rough += (deformation - 3.0 * c + 3.0 * b - a).powi(2);
        }
        self.last = [b, c, deformation];
        self.count += 1.0;
        self.sum += deformation - self.origin;
        self.square += (deformation - self.origin).powi(2);
    }

    /// Whether the variance so far is ten times that of the noise, given or estimated (from at least 16
    /// samples: fewer do not determine a variance to a factor of ten).
    pub fn hears(&self, noise_std: Option<f64>) -> bool {
        if self.count < 16.0 {
            return false;
        }
        let variance = (self.square - self.sum * self.sum / self.count) / self.count;
        let seen = self.rough / (20.0 * (self.count - 3.0));
        let given = noise_std.map_or(0.0, |std| std * std);
        variance > HEARD * seen.max(given)
    }
}

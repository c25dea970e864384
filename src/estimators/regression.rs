//! From the unknowns of eq. (4) to an estimate that settles and is then kept.

use quell_shapers::Mode;

use super::convergence::Convergence;
use super::{Estimate, Settings};

/// The estimate of a linear regression: kept once it has settled, since these estimates drift
/// away again as the vibration sinks into the noise while the regressors' noise goes on adding up.
#[derive(Clone, Copy, Debug)]
pub struct Settling {
    range: (f64, f64),
    convergence: Convergence,
    estimate: Option<Estimate>,
}

impl Settling {
    /// Nothing estimated yet.
    pub fn new(settings: &Settings) -> Self {
        Self {
            range: settings.frequency_range,
            convergence: Convergence::default(),
            estimate: None,
        }
    }

    /// Takes `alpha_1 = w^2`, `alpha_2 = 2 xi w` and a gain.
    ///
    /// What is no vibratory mode in the range that is looked for is no estimate: it is passed over.
    pub fn push(&mut self, time: f64, stiffness: f64, damping: f64, gain: f64) {
        let w = stiffness.sqrt();
        if !(w >= self.range.0 && w <= self.range.1) {
            return;
        }
        let Ok(mode) = Mode::new(w, (0.5 * damping / w).max(0.0)) else {
            return;
        };
        self.convergence.push(time, [w.ln(), 0.5 * damping / w]);
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

    /// Whether the estimate has settled and is kept.
    pub fn is_frozen(&self) -> bool {
        self.estimate.is_some_and(|estimate| estimate.converged)
    }

    /// Forgets all estimates.
    pub fn restart(&mut self) {
        self.convergence = Convergence::default();
        self.estimate = None;
    }
}

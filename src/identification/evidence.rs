//! Whether a batch fit tells a mode, or what noise and drift make as well.

use crate::estimators::Sample;
use crate::estimators::offline::BatchFit;

/// Unknowns of a mode: frequency, damping, two of its vibration.
const UNKNOWNS: f64 = 4.0;
/// Difference of the Bayesian information criterion that is very strong evidence (Kass and Raftery, J. American
/// Statistical Association 90 (1995)).
const STRONG: f64 = 10.0;

/// The likelihood ratio of a mode against none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// By how much the fit lowers chi-squared, `n ln(S0 / S1)`.
    pub found: f64,
    /// What a mode takes, `4 ln N + 10`.
    pub needed: f64,
}

impl Evidence {
    /// Of a fit to samples. `S0` is about their mean. Of `N` samples whose residual has the first
    /// autocorrelation `r`, `n = N (1 - r) / (1 + r)` are independent, 1 at least: drift is not taken for a slow mode.
    pub fn of(samples: &[Sample], fit: &BatchFit) -> Self {
        let count = samples.len() as f64;
        let mean = samples.iter().map(|s| s.deformation).sum::<f64>() / count;
        let square = |s: &Sample| (s.deformation - mean).powi(2);
        let before: f64 = samples.iter().map(square).sum();
        let left: f64 = fit.residual.iter().map(|r| r * r).sum();
        let correlation = fit.correlation.clamp(0.0, 1.0);
        let independent = (count * (1.0 - correlation) / (1.0 + correlation)).max(1.0);
        let found = independent * (before / left.max(f64::MIN_POSITIVE)).ln();
        Self {
            // Where nothing varies there is no ratio.
            found: if found.is_finite() {
                found.max(0.0)
            } else {
                0.0
            },
            needed: UNKNOWNS * count.ln() + STRONG,
        }
    }

    /// Whether it is strong.
    pub fn tells(&self) -> bool {
        self.found >= self.needed
    }
}

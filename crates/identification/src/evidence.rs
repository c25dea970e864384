//! Whether a batch fit shows a mode, or only what noise and drift could produce as well.

use super::IdentificationError;
use quell_control::estimators::Sample;
use quell_control::estimators::offline::BatchFit;

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
    /// The least evidence for a mode, `4 ln N + 10`.
    pub needed: f64,
    /// `N`.
    pub samples: usize,
}

impl Evidence {
    /// The evidence of a fit of a whole recording; 0 where no fit ended in a mode. Of `N` samples whose
    /// residual has the first autocorrelation `r`, `n = N (1 - r) / (1 + r)` are independent, so that a drift
    /// is not taken for a slow mode.
    pub fn of_all(samples: &[Sample], fit: Option<&BatchFit>) -> Self {
        let count = samples.len() as f64;
        fit.map_or(Self::none(samples.len()), |fit| {
            let r = fit.correlation.clamp(0.0, 1.0);
            Self::by(samples, fit, (count * (1.0 - r) / (1.0 + r)).max(1.0))
        })
    }

    /// The evidence of a fit of a free decay. All samples count: no drift has evenly spaced extrema.
    pub fn of_decay(samples: &[Sample], fit: &BatchFit) -> Self {
        Self::by(samples, fit, samples.len() as f64)
    }

    /// `S0` is about the mean of the samples.
    fn by(samples: &[Sample], fit: &BatchFit, independent: f64) -> Self {
        let mean = samples.iter().map(|s| s.deformation).sum::<f64>() / samples.len() as f64;
        let square = |s: &Sample| (s.deformation - mean).powi(2);
        let before: f64 = samples.iter().map(square).sum();
        let left: f64 = fit.residual.iter().map(|r| r * r).sum();
        let found = independent * (before / left.max(f64::MIN_POSITIVE)).ln();
        Self {
            // If nothing varies, the ratio is undefined.
            found: if found.is_finite() {
                found.max(0.0)
            } else {
                0.0
            },
            ..Self::none(samples.len())
        }
    }

    fn none(samples: usize) -> Self {
        Self {
            found: 0.0,
            needed: UNKNOWNS * (samples as f64).ln() + STRONG,
            samples,
        }
    }

    /// Whether the evidence is strong.
    pub fn tells(&self) -> bool {
        self.found >= self.needed
    }

    /// Refuses weak evidence.
    ///
    /// # Errors
    /// [`IdentificationError::NotExcited`].
    pub fn strong(&self) -> Result<(), IdentificationError> {
        match self.tells() {
            true => Ok(()),
            false => Err(IdentificationError::NotExcited {
                found: self.found,
                needed: self.needed,
                samples: self.samples,
            }),
        }
    }
}

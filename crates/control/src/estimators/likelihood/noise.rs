//! The noise's level with its uncertainty, and the evidence of a sum of squares relative to it.

/// Weight of a given noise level in samples, against the residual's own.
const NOISE_SAMPLES: f64 = 10.0;
/// Samples beyond the number of unknowns from which a noise level is estimated: its distribution (Student's)
/// has a variance from three on.
pub const SPARE: f64 = 4.0;

/// Variance of the noise, and its degrees of freedom.
#[derive(Clone, Copy, Debug, Default)]
pub struct Noise {
    /// Variance.
    pub variance: f64,
    /// Its degrees of freedom; 0 where it is unknown.
    pub freedom: f64,
}

impl Noise {
    /// Pools a given level (a standard deviation) with that of a sum of squares with `spare` degrees of
    /// freedom. `largest` is the largest deformation; rounding contributes 1e-24 of its square.
    pub fn pooled(given: Option<f64>, square: f64, spare: f64, largest: f64) -> Self {
        let spare = spare.max(0.0);
        let square = square.max(0.0);
        let smallest = (1e-24 * largest * largest).max(1e-60);
        let (variance, freedom) = match given {
            Some(std) => {
                let square = if spare > 0.0 { square } else { 0.0 };
                let freedom = NOISE_SAMPLES + spare;
                ((NOISE_SAMPLES * std * std + square) / freedom, freedom)
            }
            None if spare >= SPARE => (square / spare, spare),
            None => (1e-4 * largest * largest, 0.0),
        };
        Self {
            variance: variance.max(smallest),
            freedom,
        }
    }

    /// `-2 ln` of the odds against a sum of squares that is larger by `difference`, with the noise's level as
    /// uncertain as it is: `n ln(1 + d / (n s^2))`, which for many samples is `d / s^2`.
    ///
    /// Source: T. W. Anderson, An Introduction to Multivariate Statistical Analysis, ch. 8 (likelihood ratio
    /// with an unknown variance).
    pub fn evidence(&self, difference: f64) -> f64 {
        let freedom = self.freedom.max(1.0);
        freedom * (difference / (freedom * self.variance)).max(0.0).ln_1p()
    }

    /// Whether the evidence is above a limit.
    pub fn is_evident(&self, difference: f64, limit: f64) -> bool {
        let freedom = self.freedom.max(1.0);
        let ratio = (difference / (freedom * self.variance)).max(0.0);
        // 2 x / (2 + x) <= ln(1 + x) <= x decides without a logarithm, unless it is close.
        freedom * ratio > limit
            && (freedom * 2.0 * ratio > limit * (2.0 + ratio) || freedom * ratio.ln_1p() > limit)
    }

    /// The same for coloured noise, with degrees of freedom reduced by the inflation, but no less than are
    /// needed to estimate a level. 0 if the colour is not known (an infinite inflation).
    pub fn coloured_evidence(&self, difference: f64, inflation: f64) -> f64 {
        if !inflation.is_finite() {
            return 0.0;
        }
        let independent = (self.freedom / inflation).max(SPARE).min(self.freedom);
        self.evidence(difference) * independent / self.freedom.max(1.0)
    }

    /// Ratio of an unknown's variance to that of a Gaussian one: that of Student's distribution if the level
    /// was estimated.
    pub fn student(&self, given: Option<f64>) -> f64 {
        match given {
            None if self.freedom >= SPARE => self.freedom / (self.freedom - 2.0),
            _ => 1.0,
        }
    }
}

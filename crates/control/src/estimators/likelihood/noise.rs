//! The noise's level, as well as it is known, and what a sum of squares says beside it.

/// Weight of a given noise level in samples, against the residual's own.
const NOISE_SAMPLES: f64 = 10.0;
/// Samples beyond the unknowns from which a noise level is learned: its distribution (Student's) has a
/// variance from three on.
pub const SPARE: f64 = 4.0;

/// Variance of the noise, and its degrees of freedom.
#[derive(Clone, Copy, Debug, Default)]
pub struct Noise {
    /// Variance.
    pub variance: f64,
    /// Degrees of freedom of it; 0 where nothing is known.
    pub freedom: f64,
}

impl Noise {
    /// Pools a given level (a standard deviation) with that of a sum of squares of so many samples beyond
    /// the unknowns; `largest` is the largest deformation, of whose square rounding leaves 1e-24.
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

    /// `-2 ln` of the odds against a sum of squares that is larger by so much, the noise's level known as
    /// well as it is: `n ln(1 + d / (n s^2))`, which for many samples is `d / s^2`.
    ///
    /// Source: T. W. Anderson, An Introduction to Multivariate Statistical Analysis, ch. 8 (likelihood ratio
    /// with an unknown variance).
    pub fn evidence(&self, difference: f64) -> f64 {
        let freedom = self.freedom.max(1.0);
        freedom * (difference / (freedom * self.variance)).max(0.0).ln_1p()
    }

    /// Whether that is above a limit.
    pub fn is_evident(&self, difference: f64, limit: f64) -> bool {
        let freedom = self.freedom.max(1.0);
        let ratio = (difference / (freedom * self.variance)).max(0.0);
        // 2 x / (2 + x) <= ln(1 + x) <= x says it without a logarithm, unless it is close.
        freedom * ratio > limit
            && (freedom * 2.0 * ratio > limit * (2.0 + ratio) || freedom * ratio.ln_1p() > limit)
    }

    /// The same where the noise is coloured and counts for as many fewer degrees of freedom, down to those that
    /// a level is learned from; nothing where its colour is not known (an infinite inflation).
    pub fn coloured_evidence(&self, difference: f64, inflation: f64) -> f64 {
        if !inflation.is_finite() {
            return 0.0;
        }
        let independent = (self.freedom / inflation).max(SPARE).min(self.freedom);
        self.evidence(difference) * independent / self.freedom.max(1.0)
    }

    /// Variance of an unknown over that of a Gaussian one: Student's, where the level was learned.
    pub fn student(&self, given: Option<f64>) -> f64 {
        match given {
            None if self.freedom >= SPARE => self.freedom / (self.freedom - 2.0),
            _ => 1.0,
        }
    }
}

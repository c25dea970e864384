//! Whether a batch fit shows a mode, or only what noise and drift could produce as well.

use super::IdentificationError;
use super::follows::{Follows, Lags};
use quell_control::estimators::Sample;
use quell_control::estimators::offline::BatchFit;
use quell_signal::STRONG;

/// Unknowns of a mode: frequency and damping, and two of its vibration in each piece that starts freely.
const MODE: f64 = 2.0;
const START: f64 = 2.0;
/// Most lags over which a correlation is summed.
const LAGS: usize = 1000;
/// Half a step more than the two of two equal sensors: the nearest number of steps is still two.
const STEPS: f64 = 1.25;

/// The likelihood ratio of a mode against none: against a tip that only follows the motor side ([`Follows`]), or that rests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evidence {
    /// By how much the fit lowers chi-squared, `n ln(S0 / S1)`.
    pub found: f64,
    /// The least evidence for a mode, `2 ln N + 2 p ln (N / p) + 10`: each of `p` free starts is seen by `N / p` samples.
    pub needed: f64,
    /// `N`.
    pub samples: usize,
}

impl Evidence {
    /// The evidence of a fit of a whole recording, in pieces of a `memory` (s) with a free start each; 0 where no fit ended
    /// in a mode. `n` is the number of independent samples of the residual ([`independent`]), so that a drift is not
    /// taken for a slow mode.
    pub fn of_all(samples: &[Sample], fit: Option<&BatchFit>, memory: f64) -> Self {
        let none = Self::none(samples, memory);
        fit.map_or(none, |fit| {
            let follows = Follows::of(samples).residual;
            none.by(fit, follows, independent(&fit.residual))
        })
    }

    /// Refuses a mode that the sensors' rounding, which spans a range of `rounding`, or a lag of first order explain as well.
    ///
    /// The reading of a rounded position is off by half a step, at most. So a rigid joint makes a deformation that spans
    /// less than a step of each sensor, to the nearest step: what it spans has the form of the move, and fits many a mode.
    ///
    /// # Errors
    /// [`IdentificationError::Rounded`] and [`IdentificationError::Lags`].
    pub fn no_artefact(
        self,
        samples: &[Sample],
        fit: &BatchFit,
        rounding: f64,
    ) -> Result<(), IdentificationError> {
        let range = Follows::of(samples).range;
        if range <= rounding * STEPS {
            return Err(IdentificationError::Rounded { range, rounding });
        }
        let lags = Lags::of(samples);
        match self
            .by(fit, lags.residual, independent(&fit.residual))
            .tells()
        {
            true => Ok(()),
            false => Err(IdentificationError::Lags {
                time_constant: lags.time_constant,
                of_servo: false,
            }),
        }
    }

    /// The evidence of a fit of a free decay. All samples count: no drift has evenly spaced extrema.
    pub fn of_decay(samples: &[Sample], fit: &BatchFit) -> Self {
        let mean = samples.iter().map(|s| s.deformation).sum::<f64>() / samples.len() as f64;
        let rests = samples.iter().map(|s| (s.deformation - mean).powi(2)).sum();
        Self::none(samples, f64::INFINITY).by(fit, rests, samples.len() as f64)
    }

    /// `S0` is the sum of squares without a mode.
    fn by(self, fit: &BatchFit, without: f64, independent: f64) -> Self {
        let left: f64 = fit.residual.iter().map(|r| r * r).sum();
        let found = independent * (without / left.max(f64::MIN_POSITIVE)).ln();
        Self {
            // If nothing varies, the ratio is undefined.
            found: if found.is_finite() {
                found.max(0.0)
            } else {
                0.0
            },
            ..self
        }
    }

    fn none(samples: &[Sample], memory: f64) -> Self {
        let duration = samples[samples.len() - 1].time - samples[0].time;
        let pieces = (duration / memory).ceil().max(1.0);
        let count = samples.len() as f64;
        Self {
            found: 0.0,
            needed: MODE * count.ln() + START * pieces * (count / pieces).ln() + STRONG,
            samples: samples.len(),
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
                searched: None,
            }),
        }
    }
}

/// How many independent samples a residual is worth, `n / (1 + 2 sum rho_k)`: the variance of its mean is that of so
/// many. The sum ends before the first pair of neighbouring lags whose correlations add up to less than 0, from where on
/// it sums chance.
///
/// Source: the initial positive sequence, C. J. Geyer, Practical Markov chain Monte Carlo, Statistical Science 7 (1992).
fn independent(residual: &[f64]) -> f64 {
    let square: f64 = residual.iter().map(|r| r * r).sum();
    let at = |lag: usize| {
        let pairs = residual.iter().zip(&residual[lag..]);
        pairs.map(|(a, b)| a * b).sum::<f64>() / square
    };
    let lags = (1..LAGS.min(residual.len() / 2)).step_by(2);
    let positive = lags
        .map(|lag| at(lag) + at(lag + 1))
        .take_while(|pair| *pair > 0.0);
    let count = residual.len() as f64;
    let number = count / (1.0 + 2.0 * positive.sum::<f64>());
    if number.is_finite() {
        number.clamp(1.0, count)
    } else {
        1.0
    }
}

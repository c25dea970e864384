//! Least squares of a move: a sum of modes, the frequency of each a function of the pose.
//!
//! ```text
//! delta = sum_m [p_m (q_m - u) + d_m (g_m - q_m) + c_m q_m' + a_m f_m + b_m h_m] + o + K u + s u' + noise
//! ```
//! with `q_m`, `g_m`, and the free decays `f_m`, `h_m`, of [`columns`]. The shares `p`, dampers to ground `d`,
//! lags `c`, `s`, initial vibration `a`, `b`, offset `o` and gain `K` enter linearly; `ln w` at the nodes of
//! the way, and `xi`, do not. Gauss-Newton steps, damped as by Levenberg and Marquardt; the map gives Gaussian
//! priors. Variances are those of noise with the residual's density at the modes' frequencies (`density`).
//!
//! Source: L. Ljung, System Identification, 2nd ed., ch. 7.

mod density;
mod descent;
mod linear;

use nalgebra::{DVector, SMatrix};

use self::linear::COMMON;
use super::cause::Cause;
use super::path::Way;
use super::point::{OF_A_MODE, Point, Prior};
use super::response::COLUMNS;
use crate::estimators::Sample;
use crate::estimators::correlation::Correlation;

/// Unknowns of a mode.
const UNKNOWNS: usize = COLUMNS + OF_A_MODE;

/// A fitted mode of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// The mode.
    pub point: Point,
    /// Its share `p`.
    pub share: f64,
    /// Standard deviation of the share.
    pub share_std: f64,
    /// Covariance of `ln w` at the nodes and `xi`.
    pub covariance: SMatrix<f64, OF_A_MODE, OF_A_MODE>,
    /// Information of the samples alone: the precision without that of the prior.
    pub information: SMatrix<f64, OF_A_MODE, OF_A_MODE>,
    /// The prior that it was fitted with.
    pub prior: Prior,
}

/// The fit of a move.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The modes, in the order of their priors.
    pub modes: Vec<Fitted>,
    /// Sum of squares of the residual.
    pub square: f64,
    /// Number of samples in use.
    pub samples: f64,
    /// Variance of the residual.
    pub variance: f64,
    /// Variance inflation of its mean by its colour, as of AR(1) noise.
    pub inflation: f64,
    /// Part of its variance that is not white.
    pub coloured: f64,
    /// Residual at each sample; NaN for spikes.
    pub residual: Vec<f64>,
    /// Lowest and highest `ln w` in range.
    pub range: (f64, f64),
    /// What changes along the way.
    pub cause: Cause,
}

impl Fit {
    /// The coloured part of the residual's variance: the part that the modes leave unexplained.
    pub fn unexplained(&self) -> f64 {
        self.coloured * self.variance
    }
}

/// The samples of a move and its way.
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    /// Samples.
    pub samples: &'a [Sample],
    /// The way from start to end.
    pub way: Way,
    /// Lowest and highest `ln w`.
    pub range: (f64, f64),
    /// What changes along the way.
    pub cause: Cause,
    counts: Vec<bool>,
    slopes: Vec<f64>,
    largest: f64,
}

impl<'a> Problem<'a> {
    /// A problem for finite samples in the order of time.
    pub fn new(samples: &'a [Sample], way: Way, range: (f64, f64), cause: Cause) -> Self {
        let slope = |k: usize| {
            let (a, b) = (
                samples[k.saturating_sub(1)],
                samples[(k + 1).min(samples.len() - 1)],
            );
            (b.motor_position - a.motor_position) / (b.time - a.time).max(f64::MIN_POSITIVE)
        };
        Self {
            counts: vec![true; samples.len()],
            slopes: (0..samples.len()).map(slope).collect(),
            largest: samples.iter().fold(0.0, |m, s| s.deformation.abs().max(m)),
            samples,
            way,
            range,
            cause,
        }
    }

    /// Number of samples in use.
    pub fn count(&self) -> f64 {
        self.counts.iter().filter(|counts| **counts).count() as f64
    }

    /// The variance of a residual, at least that of rounding.
    fn variance(&self, square: f64, unknowns: usize) -> f64 {
        let spare = (self.count() - unknowns as f64).max(1.0);
        (square / spare)
            .max(1e-20 * self.largest * self.largest)
            .max(1e-60)
    }

    fn conclude(&self, points: &[Point], priors: &[Prior]) -> Option<Fit> {
        let unknowns = UNKNOWNS * points.len() + COMMON;
        let rough = self.solve(points, priors, 1e-6 * self.largest * self.largest)?;
        let variance = self.variance(rough.square, unknowns);
        let colour = of_colour(&rough.residual);
        let wide = variance * self.density(points, &rough.residual);
        let linear = self.solve(points, priors, wide)?;
        let (normal, _) = self.normal(points, priors, &linear, wide);
        let inverse = normal.cholesky()?.inverse() * wide;
        let first = linear.design.ncols();
        let mut modes = Vec::new();
        for (m, (&point, &prior)) in points.iter().zip(priors).enumerate() {
            let at = first + OF_A_MODE * m;
            let own = inverse
                .fixed_view::<OF_A_MODE, OF_A_MODE>(at, at)
                .into_owned();
            modes.push(Fitted {
                point,
                share: linear.unknowns[COLUMNS * m],
                share_std: inverse[(COLUMNS * m, COLUMNS * m)].sqrt(),
                covariance: own,
                information: not_negative(own.try_inverse()? - prior.precision()),
                prior,
            });
        }
        let mut residual: Vec<f64> = linear.residual.iter().copied().collect();
        for (r, counts) in residual.iter_mut().zip(&self.counts) {
            if !counts {
                *r = f64::NAN;
            }
        }
        Some(Fit {
            modes,
            square: linear.square,
            samples: self.count(),
            variance,
            inflation: colour.inflation(),
            coloured: colour.coloured(),
            residual,
            range: self.range,
            cause: self.cause,
        })
    }
}

/// A symmetric matrix without the negative eigenvalues that rounding causes.
fn not_negative(matrix: SMatrix<f64, OF_A_MODE, OF_A_MODE>) -> SMatrix<f64, OF_A_MODE, OF_A_MODE> {
    let mut eigen = (0.5 * (matrix + matrix.transpose())).symmetric_eigen();
    eigen.eigenvalues.apply(|value| *value = value.max(0.0));
    eigen.recompose()
}

/// The correlation of neighbours of a residual.
fn of_colour(residual: &DVector<f64>) -> Correlation {
    let mut correlation = Correlation::default();
    residual.iter().for_each(|r| correlation.observe(*r));
    correlation
}

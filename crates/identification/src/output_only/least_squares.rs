//! Nonlinear least squares of a few unknowns by Levenberg and Marquardt's method.

use crate::stop::Stop;
use nalgebra::{DMatrix, DVector};

/// Most iterations; the fits here end after ten to thirty.
const ITERATIONS: usize = 60;
/// Relative decrease of the cost at convergence: for 1e5 samples a hundredth of one chi-squared.
const ENDED: f64 = 1e-7;
/// Relative rounding of scaled normal equations, whose parts may cancel.
const ROUNDING: f64 = 1e-10;

/// A minimum.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// The unknowns there.
    pub at: Vec<f64>,
    /// Sum of squares there.
    pub cost: f64,
    /// Residuals there.
    pub residual: DVector<f64>,
    /// `(J^T J)^-1`; `cost / (n - p)` times it is the covariance. `None` where rounding dominates.
    pub inverse: Option<DMatrix<f64>>,
}

/// A sum of squares to be minimised.
pub trait Squares {
    /// The residuals; none where the unknowns mean nothing.
    fn residual(&self, at: &[f64]) -> Option<DVector<f64>>;

    /// `J^T J` and `J^T r` of the Jacobian there and these residuals.
    fn normal(&self, at: &[f64], residual: &DVector<f64>) -> Option<(DMatrix<f64>, DVector<f64>)>;
}

/// Descends from a start; none where a residual is not finite at the start, or it is stopped.
pub fn minimise(problem: &impl Squares, start: &[f64], stop: Stop) -> Option<Minimum> {
    let mut at = start.to_vec();
    let mut now = problem.residual(&at)?;
    let mut cost = now.norm_squared();
    let mut damping = 1e-3;
    for _ in 0..ITERATIONS {
        let (normal, gradient) = problem.normal(&at, &now)?;
        let mut better = None;
        while damping < 1e12 {
            if stop() {
                return None;
            }
            let mut damped = normal.clone();
            for k in 0..at.len() {
                damped[(k, k)] += damping * normal[(k, k)].max(f64::MIN_POSITIVE);
            }
            let step = damped.cholesky().map(|factor| factor.solve(&gradient));
            let next = step.map(|step| {
                at.iter()
                    .zip(step.iter())
                    .map(|(x, s)| x - s)
                    .collect::<Vec<_>>()
            });
            let found = next.and_then(|next| problem.residual(&next).map(|r| (next, r)));
            match found.filter(|(_, r)| r.norm_squared() < cost) {
                Some(found) => {
                    better = Some(found);
                    break;
                }
                None => damping *= 4.0,
            }
        }
        let Some((next, left)) = better else {
            break;
        };
        damping = (damping * 0.1).max(1e-12);
        let before = cost;
        (at, now) = (next, left);
        cost = now.norm_squared();
        if before - cost < ENDED * before {
            break;
        }
    }
    let inverse = inverse(&problem.normal(&at, &now)?.0);
    Some(Minimum {
        at,
        cost,
        residual: now,
        inverse,
    })
}

/// The inverse of `J^T J`. Unknowns are scaled first; one without any effect gets a large deviation, by
/// rounding.
fn inverse(normal: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let scale = normal
        .diagonal()
        .map(|own| if own > 0.0 { own.sqrt() } else { 1.0 });
    let count = normal.nrows();
    let mut scaled = DMatrix::from_fn(count, count, |a, b| normal[(a, b)] / (scale[a] * scale[b]));
    for k in 0..count {
        scaled[(k, k)] += ROUNDING;
    }
    let inverse = scaled.cholesky()?.inverse();
    Some(DMatrix::from_fn(count, count, |a, b| {
        inverse[(a, b)] / (scale[a] * scale[b])
    }))
}

/// Independent samples of a residual by its first autocorrelation `r`, `N (1 - r) / (1 + r)`: the number for noise of first order (G. V. Bayley,
/// J. M. Hammersley, The "effective" number of independent observations, J. Royal Statistical Society B 8 (1946)).
///
/// `independent` of [evidence](crate::evidence) sums all lags: there what is left is a drift, and the variance of its mean counts. What fits of decays
/// leave may vibrate. Its correlations cancel over a period, so that a sum of them tells many samples, and a slow motion would have
/// one more mode for each of its parts. `r` stays near 1 for whatever is slow beside the sampling.
pub fn by_first_lag(left: &DVector<f64>, count: usize) -> f64 {
    let pairs: f64 = left
        .as_slice()
        .windows(2)
        .map(|pair| pair[0] * pair[1])
        .sum();
    let r = (pairs / left.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (count as f64 * (1.0 - r) / (1.0 + r)).max(8.0)
}

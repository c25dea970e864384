//! One Gauss-Newton step of the likelihood from accumulated second moments.

use super::track::Track;
use crate::estimators::modal_response::{
    DEFORMATION, FREE, FREE_SLOPE, INPUT, LINK, OFFSET, RATE, RESIDUAL, VELOCITY, WIDTH,
};
use nalgebra::{SMatrix, SVector};

/// Sums of products of the columns of every row, upper triangle.
pub type Moments = [[f64; WIDTH]; WIDTH];

/// Normal equations of past stretches, their free decays eliminated: `ln w`, `xi`, offset, rate,
/// scale, gain, and the residual as last row.
pub type Past = SMatrix<f64, 7, 7>;

/// Linear unknowns: free decay (two), offset, rate, scale, gain.
const LINEAR: [usize; 6] = [FREE, FREE + 1, OFFSET, VELOCITY, DEFORMATION, INPUT];
const SCALE: usize = 4;
const RATE_GAIN: usize = 3;
const GAIN: usize = 5;

/// Gaussian priors of all unknowns: `ln w`, `xi`, then the linear ones.
#[derive(Clone, Copy, Debug)]
pub struct Priors {
    /// Means of `ln w` and `xi`.
    pub mean: [f64; 2],
    /// Inverse variances of the eight unknowns.
    pub precision: [f64; 8],
}

/// What the moments say at and near their linearisation.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Sum of squares at the linearisation point itself, linear unknowns at their best.
    pub cost: f64,
    /// The same at the end of the step, as the linearisation predicts it.
    pub cost_after: f64,
    /// Step of `ln w` and `xi`.
    pub step: [f64; 2],
    /// Covariance of `ln w`, `xi` for a noise of unit variance.
    pub covariance: [[f64; 2]; 2],
    /// Static gain and its variance for a noise of unit variance.
    pub gain: (f64, f64),
    /// Weights of a row's columns that give the residual after the step.
    pub residual: [f64; WIDTH],
}

/// Solves `matrix x = rhs` after scaling the columns to unit length; the inverse comes with it.
fn solve<const N: usize>(
    matrix: &SMatrix<f64, N, N>,
    rhs: &SVector<f64, N>,
) -> Option<(SVector<f64, N>, SMatrix<f64, N, N>)> {
    let mut scale = SVector::<f64, N>::zeros();
    for i in 0..N {
        let diagonal = matrix[(i, i)];
        if !(diagonal.is_finite() && diagonal > 0.0) {
            return None;
        }
        scale[i] = diagonal.sqrt().recip();
    }
    let scaled = SMatrix::<f64, N, N>::from_fn(|i, j| {
        // 1e-13: what rounding of the sums may leave on an exactly dependent pair of columns.
        matrix[(i, j)] * scale[i] * scale[j] + if i == j { 1e-13 } else { 0.0 }
    });
    let mut inverse = scaled.cholesky()?.inverse();
    for i in 0..N {
        for j in 0..N {
            inverse[(i, j)] *= scale[i] * scale[j];
        }
    }
    Some((inverse * rhs, inverse))
}

fn moment(moments: &Moments, i: usize, j: usize) -> f64 {
    if i <= j { moments[i][j] } else { moments[j][i] }
}

/// Best linear unknowns at the linearisation point, and the sum of squares there.
pub fn profile(track: &Track, priors: &Priors, variance: f64) -> Option<(SVector<f64, 6>, f64)> {
    let (moments, past, mode) = (&track.moments, &track.past, track.mode);
    let mut normal = SMatrix::<f64, 6, 6>::zeros();
    let mut rhs = SVector::<f64, 6>::zeros();
    for (i, &p) in LINEAR.iter().enumerate() {
        for (j, &q) in LINEAR.iter().enumerate() {
            normal[(i, j)] = moment(moments, p, q);
            if i >= 2 && j >= 2 {
                normal[(i, j)] += past[(i, j)];
            }
        }
        normal[(i, i)] += variance * priors.precision[i + 2];
        rhs[i] = moment(moments, p, RESIDUAL) + if i >= 2 { past[(i, 6)] } else { 0.0 };
    }
    let (linear, _) = solve(&normal, &rhs)?;
    let miss = [
        mode.natural_frequency().ln() - priors.mean[0],
        mode.damping_ratio() - priors.mean[1],
    ];
    let prior: f64 = (0..2)
        .map(|k| priors.precision[k] * miss[k] * miss[k])
        .sum();
    let square = moments[RESIDUAL][RESIDUAL] + past[(6, 6)];
    Some((linear, square - linear.dot(&rhs) + variance * prior))
}

/// A row's columns as derivatives by the eight unknowns, at these linear ones.
///
/// The derivatives by the mode contain the linear unknowns: the free decay's amplitude, the rate's
/// coefficient, the scale.
fn derivatives(track: &Track, linear: &SVector<f64, 6>) -> SMatrix<f64, 8, WIDTH> {
    let mut rows = SMatrix::<f64, 8, WIDTH>::zeros();
    for (k, slope) in track.response.lambda_slopes().iter().enumerate() {
        // Re((a - j b) e^(lambda t)) has the derivative Re((a - j b) lambda_p t e^(lambda t)).
        let turned = nalgebra::Complex::new(linear[0], -linear[1]) * slope;
        rows[(k, LINK + k)] = 1.0 + linear[SCALE];
        rows[(k, RATE + k)] = linear[RATE_GAIN];
        rows[(k, FREE_SLOPE)] = turned.re;
        rows[(k, FREE_SLOPE + 1)] = -turned.im;
    }
    for (i, &p) in LINEAR.iter().enumerate() {
        rows[(i + 2, p)] = 1.0;
    }
    rows
}

/// Adds the present stretch to the past: its free decay is eliminated (Schur complement).
pub fn fold(track: &Track, priors: &Priors, variance: f64) -> Option<Past> {
    let (linear, _) = profile(track, priors, variance)?;
    let mut rows = SMatrix::<f64, 9, WIDTH>::zeros();
    rows.fixed_rows_mut::<8>(0)
        .copy_from(&derivatives(track, &linear));
    rows[(8, RESIDUAL)] = 1.0;
    let full = SMatrix::<f64, WIDTH, WIDTH>::from_fn(|i, j| moment(&track.moments, i, j));
    let mut normal = rows * full * rows.transpose();
    normal[(2, 2)] += variance * priors.precision[2];
    normal[(3, 3)] += variance * priors.precision[3];
    const SHARED: [usize; 7] = [0, 1, 4, 5, 6, 7, 8];
    let free = normal.fixed_view::<2, 2>(2, 2).into_owned();
    let inverse = free.try_inverse()?;
    let cross = SMatrix::<f64, 7, 2>::from_fn(|i, j| normal[(SHARED[i], 2 + j)]);
    let shared = Past::from_fn(|i, j| normal[(SHARED[i], SHARED[j])]);
    Some(track.past + shared - cross * inverse * cross.transpose())
}

/// One Gauss-Newton step of all eight unknowns.
pub fn fit(track: &Track, priors: &Priors, variance: f64) -> Option<Fit> {
    let (linear, cost) = profile(track, priors, variance)?;
    let rows = derivatives(track, &linear);
    let full = SMatrix::<f64, WIDTH, WIDTH>::from_fn(|i, j| moment(&track.moments, i, j));
    let product = rows * full;
    let mut normal = product * rows.transpose();
    let mut rhs: SVector<f64, 8> = product.column(RESIDUAL).into_owned();
    const SHARED: [usize; 6] = [0, 1, 4, 5, 6, 7];
    for (i, &p) in SHARED.iter().enumerate() {
        for (j, &q) in SHARED.iter().enumerate() {
            normal[(p, q)] += track.past[(i, j)];
        }
        rhs[p] += track.past[(i, 6)];
    }
    let point = [
        track.mode.natural_frequency().ln(),
        track.mode.damping_ratio(),
    ];
    for i in 0..8 {
        let weight = variance * priors.precision[i];
        normal[(i, i)] += weight;
        if i < 2 {
            rhs[i] += weight * (priors.mean[i] - point[i]);
        }
    }
    let (solution, inverse) = solve(&normal, &rhs)?;
    // From the profile at the point to the end of the step; linear unknowns start at `linear`.
    let mut start = SVector::<f64, 8>::zeros();
    start.fixed_rows_mut::<6>(2).copy_from(&linear);
    let gain = (solution - start).dot(&(normal * (solution - start)));
    let mut residual = [0.0; WIDTH];
    for (j, weight) in residual.iter_mut().enumerate() {
        *weight = -(0..8).map(|i| solution[i] * rows[(i, j)]).sum::<f64>();
    }
    residual[RESIDUAL] = 1.0;
    Some(Fit {
        cost,
        cost_after: cost - gain,
        step: [solution[0], solution[1]],
        covariance: [
            [inverse[(0, 0)], inverse[(0, 1)]],
            [inverse[(1, 0)], inverse[(1, 1)]],
        ],
        gain: (solution[2 + GAIN], inverse[(2 + GAIN, 2 + GAIN)]),
        residual,
    })
}

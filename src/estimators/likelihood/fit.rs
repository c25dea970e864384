//! One Gauss-Newton step of the likelihood from accumulated second moments.

use super::cholesky::Cholesky;
use super::track::Track;
use crate::estimators::modal_response::{
    DEFORMATION, FREE, FREE_SLOPE, INPUT, LINK, OFFSET, RATE, RESIDUAL, VELOCITY, WIDTH,
};
use nalgebra::SMatrix;

/// Sums of products of the columns of every row.
pub type Moments = [[f64; WIDTH]; WIDTH];

/// Normal equations of past stretches, their free decays eliminated: `ln w`, `xi`, offset, rate,
/// scale, gain, and the residual as last row.
pub type Past = SMatrix<f64, 7, 7>;

/// Linear unknowns: free decay (two), offset, rate, scale, gain. They come first, so that the factor of
/// their normal equations is the beginning of that of all eight.
const LINEAR: [usize; 6] = [FREE, FREE + 1, OFFSET, VELOCITY, DEFORMATION, INPUT];
const SCALE: usize = 4;
const RATE_GAIN: usize = 3;
const GAIN: usize = 5;
/// Where `ln w` and `xi` come among the eight.
const MODE: usize = 6;
/// Where the eight stand in [`Past`]; the free decay is in none.
const PLACE: [Option<usize>; 8] = [
    None,
    None,
    Some(2),
    Some(3),
    Some(4),
    Some(5),
    Some(0),
    Some(1),
];

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
    /// Unknowns that the samples determine rather than the priors, from above: each counts by the
    /// samples' share in what is known of it beside all others.
    pub unknowns: f64,
    slopes: [Slope; 2],
    factor: Cholesky<8>,
}

impl Fit {
    /// Variance of what is predicted for a row, for a noise of unit variance.
    pub fn doubt(&self, row: &[f64; WIDTH]) -> f64 {
        let mut derivatives = [0.0; 8];
        for (derivative, &column) in derivatives.iter_mut().zip(&LINEAR) {
            *derivative = row[column];
        }
        for (k, slope) in self.slopes.iter().enumerate() {
            derivatives[MODE + k] = slope.iter().map(|&(column, c)| c * row[column]).sum();
        }
        self.factor
            .forward(&derivatives, 8)
            .iter()
            .map(|y| y * y)
            .sum()
    }
}

/// The derivative of a row by `ln w` or `xi`: columns and their weights.
///
/// The derivatives by the mode contain the linear unknowns: the free decay's amplitude, the rate's
/// coefficient, the scale.
type Slope = [(usize, f64); 4];

fn slopes(track: &Track, linear: &[f64; 8]) -> [Slope; 2] {
    let turns = track.response.lambda_slopes();
    core::array::from_fn(|k| {
        // Re((a - j b) e^(lambda t)) has the derivative Re((a - j b) lambda_p t e^(lambda t)).
        let turned = nalgebra::Complex::new(linear[0], -linear[1]) * turns[k];
        [
            (LINK + k, 1.0 + linear[SCALE]),
            (RATE + k, linear[RATE_GAIN]),
            (FREE_SLOPE, turned.re),
            (FREE_SLOPE + 1, -turned.im),
        ]
    })
}

/// The linear unknowns at their best for a track's mode.
struct Profile {
    factor: Cholesky<8>,
    /// The factor's inverse times the right-hand side.
    forward: [f64; 8],
    cost: f64,
}

/// Adds to a row of the normal equations, and to its right-hand side, what past stretches say; the residual
/// is the seventh of [`Past`].
fn add_past(track: &Track, i: usize, row: &mut [f64; 8], rhs: &mut f64) {
    let (true, Some(p)) = (track.has_past, PLACE[i]) else {
        return;
    };
    for (entry, place) in row.iter_mut().zip(PLACE).take(i + 1) {
        *entry += place.map_or(0.0, |q| track.past[(p, q)]);
    }
    *rhs += track.past[(p, 6)];
}

fn solve_linear(track: &Track, priors: &Priors, variance: f64) -> Option<Profile> {
    let (moments, mode) = (&track.moments, track.mode);
    let mut factor = Cholesky::default();
    let mut rhs = [0.0; 8];
    for (i, &p) in LINEAR.iter().enumerate() {
        let mut row = [0.0; 8];
        for (j, &q) in LINEAR.iter().enumerate().take(i + 1) {
            row[j] = moments[p][q];
        }
        rhs[i] = moments[p][RESIDUAL];
        add_past(track, i, &mut row, &mut rhs[i]);
        row[i] += variance * priors.precision[i + 2];
        factor.append(i, &row)?;
    }
    let forward = factor.forward(&rhs, MODE);
    let miss = [
        mode.natural_frequency().ln() - priors.mean[0],
        mode.damping_ratio() - priors.mean[1],
    ];
    let prior: f64 = (0..2)
        .map(|k| priors.precision[k] * miss[k] * miss[k])
        .sum();
    let square = moments[RESIDUAL][RESIDUAL] + track.past[(6, 6)];
    let explained: f64 = forward.iter().map(|y| y * y).sum();
    Some(Profile {
        factor,
        forward,
        cost: square - explained + variance * prior,
    })
}

/// Sum of squares at a track's mode, the linear unknowns at their best.
pub fn profile(track: &Track, priors: &Priors, variance: f64) -> Option<f64> {
    solve_linear(track, priors, variance).map(|profile| profile.cost)
}

/// Adds the present stretch to the past: its free decay is eliminated (Schur complement).
pub fn fold(track: &Track, priors: &Priors, variance: f64) -> Option<Past> {
    let Profile {
        factor, forward, ..
    } = solve_linear(track, priors, variance)?;
    let linear = factor.backward(&forward, MODE);
    let mut rows = SMatrix::<f64, 9, WIDTH>::zeros();
    for (k, slope) in slopes(track, &linear).iter().enumerate() {
        for &(column, weight) in slope {
            rows[(k, column)] = weight;
        }
    }
    for (i, &column) in LINEAR.iter().enumerate() {
        rows[(i + 2, column)] = 1.0;
    }
    rows[(8, RESIDUAL)] = 1.0;
    let full = SMatrix::<f64, WIDTH, WIDTH>::from_fn(|i, j| track.moments[i][j]);
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

/// Adds `ln w` and `xi` to the normal equations of the linear unknowns.
fn add_mode(
    track: &Track,
    priors: &Priors,
    variance: f64,
    slopes: &[Slope; 2],
    profile: &mut Profile,
) -> Option<()> {
    let point = [
        track.mode.natural_frequency().ln(),
        track.mode.damping_ratio(),
    ];
    let mut products = [[0.0; WIDTH]; 2];
    for (k, slope) in slopes.iter().enumerate() {
        for &(column, weight) in slope {
            for (product, moment) in products[k].iter_mut().zip(&track.moments[column]) {
                *product += weight * moment;
            }
        }
        let mut row = [0.0; 8];
        for (i, &column) in LINEAR.iter().enumerate() {
            row[i] = products[k][column];
        }
        for (entry, product) in row[MODE..].iter_mut().zip(&products).take(k + 1) {
            *entry = slope.iter().map(|&(c, w)| w * product[c]).sum();
        }
        let weight = variance * priors.precision[k];
        let mut rhs = products[k][RESIDUAL] + weight * (priors.mean[k] - point[k]);
        add_past(track, MODE + k, &mut row, &mut rhs);
        row[MODE + k] += weight;
        profile.factor.append(MODE + k, &row)?;
        profile.forward[MODE + k] = profile.factor.next_forward(&profile.forward, MODE + k, rhs);
    }
    Some(())
}

/// Weights of a row's columns that give the residual of a solution.
fn residual(solution: &[f64; 8], slopes: &[Slope; 2]) -> [f64; WIDTH] {
    let mut residual = [0.0; WIDTH];
    for (&column, unknown) in LINEAR.iter().zip(solution) {
        residual[column] = -unknown;
    }
    for (slope, unknown) in slopes.iter().zip(&solution[MODE..]) {
        for &(column, weight) in slope {
            residual[column] -= unknown * weight;
        }
    }
    residual[RESIDUAL] = 1.0;
    residual
}

/// How many unknowns the samples determine.
fn determined(factor: &Cholesky<8>, priors: &Priors, variance: f64) -> f64 {
    let share = |i: usize| {
        let precision = priors.precision[(i + 2) % 8];
        1.0 - (variance * precision / factor.diagonal(i)).min(1.0)
    };
    (0..8).map(share).sum()
}

/// One Gauss-Newton step of all eight unknowns.
pub fn fit(track: &Track, priors: &Priors, variance: f64) -> Option<Fit> {
    let mut profile = solve_linear(track, priors, variance)?;
    let linear = profile.factor.backward(&profile.forward, MODE);
    let slopes = slopes(track, &linear);
    add_mode(track, priors, variance, &slopes, &mut profile)?;
    let Profile {
        factor,
        forward,
        cost,
    } = profile;
    let solution = factor.backward(&forward, 8);
    Some(Fit {
        cost,
        // What the step gains beyond the best linear unknowns.
        cost_after: cost - forward[MODE].powi(2) - forward[MODE + 1].powi(2),
        step: [solution[MODE], solution[MODE + 1]],
        covariance: [MODE, MODE + 1]
            .map(|i| [factor.inverse(i, MODE), factor.inverse(i, MODE + 1)]),
        gain: (solution[GAIN], factor.inverse(GAIN, GAIN)),
        residual: residual(&solution, &slopes),
        unknowns: determined(&factor, priors, variance),
        slopes,
        factor,
    })
}

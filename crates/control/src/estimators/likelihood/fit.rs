//! One Gauss-Newton step of the likelihood from accumulated second moments.

use super::cholesky::Cholesky;
use super::moments::Moments;
use super::priors::Priors;
use super::track::{Past, Track};
use crate::estimators::modal_response::{FREE, FREE_SLOPE, LINK, RATE, RESIDUAL, WIDTH};
use nalgebra::SMatrix;

/// Column of the first of the linear unknowns: free decay (two), offset, rate, scale, gain. They come first, so
/// that the factor of their normal equations is the leading part of that of all eight.
const LINEAR: usize = FREE;
const SCALE: usize = 4;
const RATE_GAIN: usize = 3;
const GAIN: usize = 5;
/// Position of `ln w` and `xi` among the eight.
const MODE: usize = 6;
/// Positions of the eight in [`Past`], which does not contain the free decay.
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

/// The fit from the moments near their linearisation.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Sum of squares at the linearisation point, with the best linear unknowns.
    pub cost: f64,
    /// The same at the end of the step, as the linearisation predicts it.
    pub cost_after: f64,
    /// Step of `ln w` and `xi`.
    pub step: [f64; 2],
    /// Variances of `ln w`, `xi` for a noise of unit variance.
    pub variances: [f64; 2],
    /// Static gain and its variance for a noise of unit variance.
    pub gain: (f64, f64),
    /// Weights of a row's columns that give the residual after the step.
    pub residual: [f64; WIDTH],
    /// Upper bound of the number of unknowns that the samples determine rather than the priors. Each counts by
    /// the samples' share of its information, given all others.
    pub unknowns: f64,
    slopes: [Slope; 2],
    factor: Cholesky<8>,
}

impl Fit {
    /// Variance of the prediction for a row, for a noise of unit variance.
    pub fn doubt(&self, row: &[f64; WIDTH]) -> f64 {
        let mut derivatives = [0.0; 8];
        derivatives[..MODE].copy_from_slice(&row[LINEAR..RESIDUAL]);
        for (k, slope) in self.slopes.iter().enumerate() {
            derivatives[MODE + k] = weighted(k, slope).map(|(column, c)| c * row[column]).sum();
        }
        let forward = self.factor.forward::<8>(&derivatives);
        (0..8).map(|n| self.factor.explained(&forward, n)).sum()
    }
}

/// The derivative of a row by `ln w` or `xi`: weights of its columns.
///
/// The derivatives by the mode contain the linear unknowns: the free decay's amplitude, the rate's
/// coefficient, the scale.
type Slope = [f64; 4];

/// The columns of the derivative by `ln w` (0) or `xi` (1).
#[inline(always)]
fn columns(k: usize) -> [usize; 4] {
    [LINK + k, RATE + k, FREE_SLOPE, FREE_SLOPE + 1]
}

/// The columns of a derivative with their weights.
#[inline(always)]
fn weighted(k: usize, slope: &Slope) -> impl Iterator<Item = (usize, f64)> {
    columns(k).into_iter().zip(*slope)
}

#[inline(always)]
fn slopes(track: &Track, linear: &[f64; 8]) -> [Slope; 2] {
    track.response.lambda_slopes().map(|turn| {
        // Re((a - j b) e^(lambda t)) has the derivative Re((a - j b) lambda_p t e^(lambda t)).
        let turned = nalgebra::Complex::new(linear[0], -linear[1]) * turn;
        [
            1.0 + linear[SCALE],
            linear[RATE_GAIN],
            turned.re,
            -turned.im,
        ]
    })
}

/// The best linear unknowns for a track's mode.
struct Profile {
    factor: Cholesky<8>,
    /// The factor's inverse times the right-hand side.
    forward: [f64; 8],
    cost: f64,
}

/// Adds the information of past stretches to a row of the normal equations and to its right-hand side. The
/// residual is the seventh column of [`Past`].
#[inline]
fn add_past(track: &Track, i: usize, row: &mut [f64; 8], rhs: &mut f64) {
    let (true, Some(p)) = (track.has_past, PLACE[i]) else {
        return;
    };
    for (entry, place) in row.iter_mut().zip(PLACE).take(i + 1) {
        *entry += place.map_or(0.0, |q| track.past[(p, q)]);
    }
    *rhs += track.past[(p, 6)];
}

#[inline(always)]
fn solve_linear(track: &Track, priors: &Priors, variance: f64) -> Option<Profile> {
    let prior: f64 = (0..2)
        .map(|k| priors.precision[k] * (track.point[k] - priors.mean[k]).powi(2))
        .sum();
    let mut profile = Profile {
        factor: Cholesky::default(),
        forward: [0.0; 8],
        cost: track.moments.of(RESIDUAL, RESIDUAL) + track.past[(6, 6)] + variance * prior,
    };
    profile.add::<0>(track, priors, variance)?;
    profile.add::<1>(track, priors, variance)?;
    profile.add::<2>(track, priors, variance)?;
    profile.add::<3>(track, priors, variance)?;
    profile.add::<4>(track, priors, variance)?;
    profile.add::<5>(track, priors, variance)?;
    Some(profile)
}

impl Profile {
    /// Adds a linear unknown.
    #[inline(always)]
    fn add<const I: usize>(&mut self, track: &Track, priors: &Priors, variance: f64) -> Option<()> {
        let mut row = [0.0; 8];
        for (j, entry) in row.iter_mut().enumerate().take(I + 1) {
            *entry = track.moments.line(LINEAR + j)[LINEAR + I];
        }
        let mut rhs = track.moments.line(LINEAR + I)[RESIDUAL];
        add_past(track, I, &mut row, &mut rhs);
        row[I] += variance * priors.precision[I + 2];
        self.factor.append(I, &row)?;
        self.forward[I] = self.factor.next_forward(&self.forward, I, rhs);
        self.cost -= self.factor.explained(&self.forward, I);
        Some(())
    }

    /// Adds `ln w` and `xi`.
    #[inline(always)]
    fn add_mode<const I: usize>(
        &mut self,
        track: &Track,
        priors: &Priors,
        variance: f64,
        slopes: &[Slope; 2],
    ) -> Option<()> {
        let k = I - MODE;
        let mut row = [0.0; 8];
        let weight = variance * priors.precision[k];
        let mut rhs = weight * (priors.mean[k] - track.point[k]);
        for (column, weight) in weighted(k, &slopes[k]) {
            let line = track.moments.line(column);
            for (product, moment) in row.iter_mut().zip(&line[LINEAR..RESIDUAL]) {
                *product += weight * moment;
            }
            rhs += weight * line[RESIDUAL];
        }
        for l in 0..=k {
            row[MODE + l] = product_of(&track.moments, slopes, [k, l]);
        }
        add_past(track, I, &mut row, &mut rhs);
        row[I] += weight;
        self.factor.append(I, &row)?;
        self.forward[I] = self.factor.next_forward(&self.forward, I, rhs);
        Some(())
    }
}

/// Sum of the products of two derivatives.
#[inline(always)]
fn product_of(moments: &Moments, slopes: &[Slope; 2], [k, l]: [usize; 2]) -> f64 {
    let mut sum = 0.0;
    for (i, weight) in weighted(k, &slopes[k]) {
        for (j, other) in weighted(l, &slopes[l]) {
            sum += weight * other * moments.of(i, j);
        }
    }
    sum
}

/// Sum of squares at a track's mode, with the best linear unknowns.
pub fn profile(track: &Track, priors: &Priors, variance: f64) -> Option<f64> {
    solve_linear(track, priors, variance).map(|profile| profile.cost)
}

/// Adds the present stretch to the past: its free decay is eliminated (Schur complement).
pub fn fold(track: &Track, priors: &Priors, variance: f64) -> Option<Past> {
    let Profile {
        factor, forward, ..
    } = solve_linear(track, priors, variance)?;
    let linear = factor.backward::<MODE>(&forward);
    let mut rows = SMatrix::<f64, 9, WIDTH>::zeros();
    for (k, slope) in slopes(track, &linear).iter().enumerate() {
        for (column, weight) in weighted(k, slope) {
            rows[(k, column)] = weight;
        }
    }
    for i in 0..MODE {
        rows[(i + 2, LINEAR + i)] = 1.0;
    }
    rows[(8, RESIDUAL)] = 1.0;
    let full = SMatrix::<f64, WIDTH, WIDTH>::from_fn(|i, j| track.moments.of(i, j));
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

/// Weights of a row's columns that give the residual of a solution.
#[inline(always)]
fn residual(solution: &[f64; 8], slopes: &[Slope; 2]) -> [f64; WIDTH] {
    let mut residual = [0.0; WIDTH];
    for (weight, unknown) in residual[LINEAR..RESIDUAL].iter_mut().zip(solution) {
        *weight = -unknown;
    }
    for (k, slope) in slopes.iter().enumerate() {
        for (column, weight) in weighted(k, slope) {
            residual[column] -= solution[MODE + k] * weight;
        }
    }
    residual[RESIDUAL] = 1.0;
    residual
}

/// Number of unknowns that the samples determine.
#[inline(always)]
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
    let linear = profile.factor.backward::<MODE>(&profile.forward);
    let slopes = slopes(track, &linear);
    profile.add_mode::<MODE>(track, priors, variance, &slopes)?;
    profile.add_mode::<{ MODE + 1 }>(track, priors, variance, &slopes)?;
    let Profile {
        factor,
        forward,
        cost,
    } = profile;
    let solution = factor.backward::<8>(&forward);
    Some(Fit {
        cost,
        // The further gain of the step, beyond the best linear unknowns.
        cost_after: cost - factor.explained(&forward, MODE) - factor.explained(&forward, MODE + 1),
        step: [solution[MODE], solution[MODE + 1]],
        variances: [factor.inverse(MODE), factor.inverse(MODE + 1)],
        gain: (solution[GAIN], factor.inverse(GAIN)),
        residual: residual(&solution, &slopes),
        unknowns: determined(&factor, priors, variance),
        slopes,
        factor,
    })
}

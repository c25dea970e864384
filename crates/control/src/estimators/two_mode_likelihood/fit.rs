//! One Gauss-Newton step of the two-mode likelihood from accumulated second moments.

use nalgebra::Complex;
use quell_shapers::Mode;

use super::pair::{
    CONSTANT, MISS, OF_A_MODE, Pair, RATE_COLUMN, Row, SHAPE_COLUMN, TOTAL_INPUT, WIDTH, points,
};
use crate::estimators::Settings;
use crate::estimators::likelihood::cholesky::Cholesky;
use crate::estimators::likelihood::inverse_square;
use crate::estimators::modal_response::{FREE, FREE_SLOPE, LINK, RATE};

/// Unknowns: ten linear ones, then `ln w` and `xi` of both modes.
pub const UNKNOWNS: usize = 14;
/// Position of the modes among the unknowns.
const MODES: usize = 10;

/// Columns of the linear unknowns: the free decays' amplitudes, offset, the rates' coefficients, scale, the
/// second mode's share, gain.
const LINEAR: [usize; MODES] = [
    FREE,
    FREE + 1,
    OF_A_MODE + FREE,
    OF_A_MODE + FREE + 1,
    CONSTANT,
    RATE_COLUMN,
    OF_A_MODE + RATE_COLUMN,
    SHAPE_COLUMN,
    OF_A_MODE + SHAPE_COLUMN,
    TOTAL_INPUT,
];
const RATES: [usize; 2] = [5, 6];
const SCALE: usize = 7;
const SHARE: usize = 8;
const GAIN: usize = 9;

/// Gaussian priors of all unknowns, in their order; means of the linear ones are 0.
#[derive(Clone, Copy, Debug)]
pub struct Priors {
    /// Means of `ln w` and `xi`, for both modes.
    pub mean: [f64; 2],
    /// Inverse variances.
    pub precision: [f64; UNKNOWNS],
}

impl Priors {
    /// Those of the settings under a noise that is known, the modes being free.
    pub fn of_known_noise(settings: &Settings, modes: [Mode; 2], noise_std: f64) -> Self {
        let offset = inverse_square(settings.offset_std.unwrap_or(noise_std));
        let rate = modes.map(|mode| mode.natural_frequency().powi(2));
        let scale = inverse_square(settings.scale_std);
        let gain = inverse_square(settings.gain_std);
        Self {
            // The mean does not matter.
            mean: [0.0; 2],
            precision: [
                0.0, 0.0, 0.0, 0.0, offset, rate[0], rate[1], scale, 1.0, gain, 0.0, 0.0, 0.0, 0.0,
            ],
        }
    }
}

/// The fit from the moments near their linearisation.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Sum of squares at the linearisation point, with the best linear unknowns.
    pub cost: f64,
    /// The same at the end of the step, as the linearisation predicts it.
    pub cost_after: f64,
    /// Step of `ln w_1`, `xi_1`, `ln w_2`, `xi_2`.
    pub step: [f64; 4],
    /// Covariance of the same for a noise of unit variance.
    pub covariance: [[f64; 4]; 4],
    /// Static gain and its variance for a noise of unit variance.
    pub gain: (f64, f64),
    /// Each mode's share of what a motion of the motor side shows: both add up to 1.
    pub shares: [f64; 2],
    /// Weights of a row's columns that give the residual after the step.
    pub residual: Row,
    /// Weights of a row's columns that give the residual with the linear unknowns alone.
    pub linear_residual: Row,
    /// Unknowns that the samples determine rather than the priors.
    pub unknowns: f64,
    /// Sum of squares of each mode's part of the deformation.
    pub energy: [f64; 2],
}

/// The best linear unknowns at a pair's modes.
pub struct LinearFit {
    /// Weights of a row's columns that give the residual.
    pub residual: Row,
    /// Each mode's share of what a motion of the motor side shows: both add up to 1.
    pub shares: [f64; 2],
}

impl LinearFit {
    /// Amplitudes of each mode's free vibration, and the offset.
    pub fn undriven(&self) -> ([[f64; 2]; 2], f64) {
        let of = |column: usize| -self.residual[column];
        let free = [0, 1].map(|m| [FREE, FREE + 1].map(|k| of(m * OF_A_MODE + k)));
        (free, of(CONSTANT))
    }
}

/// The derivative of a row by `ln w` or `xi` of a mode: columns and their weights.
type Slope = [(usize, f64); 4];

/// A mode's share of the static compliance: both add up to 1 plus the error of the scale.
fn shares(linear: &[f64; UNKNOWNS]) -> [f64; 2] {
    [1.0 + linear[SCALE] - linear[SHARE], linear[SHARE]]
}

fn slopes(pair: &Pair, linear: &[f64; UNKNOWNS]) -> [Slope; 4] {
    let shares = shares(linear);
    core::array::from_fn(|n| {
        let (mode, k) = (n / 2, n % 2);
        let first = mode * OF_A_MODE;
        // Re((a - j b) e^(lambda t)) has the derivative Re((a - j b) lambda_p t e^(lambda t)).
        let amplitude = Complex::new(linear[2 * mode], -linear[2 * mode + 1]);
        let turned = amplitude * pair.turns(mode)[k];
        [
            (first + LINK + k, shares[mode]),
            (first + RATE + k, linear[RATES[mode]]),
            (first + FREE_SLOPE, turned.re),
            (first + FREE_SLOPE + 1, -turned.im),
        ]
    })
}

/// The best linear unknowns for a pair's modes.
struct Profile {
    factor: Cholesky<UNKNOWNS>,
    forward: [f64; UNKNOWNS],
    cost: f64,
}
fn solve_linear(pair: &Pair, priors: &Priors, variance: f64) -> Option<Profile> {
    let mut factor = Cholesky::default();
    let mut rhs = [0.0; UNKNOWNS];
    for (i, &p) in LINEAR.iter().enumerate() {
        let mut row = [0.0; UNKNOWNS];
        for (j, &q) in LINEAR.iter().enumerate().take(i + 1) {
            row[j] = pair.moment(p, q);
        }
        rhs[i] = pair.moment(p, MISS);
        row[i] += variance * priors.precision[i];
        factor.append(i, &row)?;
    }
    let forward = factor.forward::<MODES>(&rhs);
    let prior: f64 = points(pair.modes)
        .iter()
        .enumerate()
        .map(|(n, value)| priors.precision[MODES + n] * (value - priors.mean[n % 2]).powi(2))
        .sum();
    let explained: f64 = (0..MODES).map(|n| factor.explained(&forward, n)).sum();
    Some(Profile {
        factor,
        forward,
        cost: pair.moment(MISS, MISS) - explained + variance * prior,
    })
}

/// Sum of squares at a pair's modes, with the best linear unknowns.
pub fn profile(pair: &Pair, priors: &Priors, variance: f64) -> Option<f64> {
    solve_linear(pair, priors, variance).map(|profile| profile.cost)
}

/// The linear unknowns alone, the modes being known.
pub fn linear(pair: &Pair, priors: &Priors, variance: f64) -> Option<LinearFit> {
    let profile = solve_linear(pair, priors, variance)?;
    let solution = profile.factor.backward::<MODES>(&profile.forward);
    let [_, residual] = residuals(&solution, &slopes(pair, &solution));
    Some(LinearFit {
        residual,
        shares: relative(&solution),
    })
}

/// The shares of the modes over their sum.
fn relative(linear: &[f64; UNKNOWNS]) -> [f64; 2] {
    shares(linear).map(|own| own / (1.0 + linear[SCALE]))
}

/// Adds both modes to the normal equations of the linear unknowns; each diagonal element is increased by a
/// share `damping` (Levenberg and Marquardt).
fn add_modes(
    pair: &Pair,
    (priors, variance): (&Priors, f64),
    damping: &[f64; 4],
    slopes: &[Slope; 4],
    profile: &mut Profile,
) -> Option<()> {
    let point = points(pair.modes);
    let product = |slope: &Slope, column: usize| -> f64 {
        slope.iter().map(|&(c, w)| w * pair.moment(c, column)).sum()
    };
    for n in 0..4 {
        let mut row = [0.0; UNKNOWNS];
        for (i, &column) in LINEAR.iter().enumerate() {
            row[i] = product(&slopes[n], column);
        }
        for (entry, other) in row[MODES..].iter_mut().zip(slopes).take(n + 1) {
            *entry = other.iter().map(|&(c, w)| w * product(&slopes[n], c)).sum();
        }
        let weight = variance * priors.precision[MODES + n];
        let rhs = product(&slopes[n], MISS) + weight * (priors.mean[n % 2] - point[n]);
        row[MODES + n] = (row[MODES + n] + weight) * (1.0 + damping[n]);
        profile.factor.append(MODES + n, &row)?;
        profile.forward[MODES + n] = profile
            .factor
            .next_forward(&profile.forward, MODES + n, rhs);
    }
    Some(())
}

/// Weights of a row's columns that give the residual of a solution, and of its linear part alone.
fn residuals(solution: &[f64; UNKNOWNS], slopes: &[Slope; 4]) -> [Row; 2] {
    let mut linear = [0.0; WIDTH];
    for (&column, unknown) in LINEAR.iter().zip(solution) {
        linear[column] = -unknown;
    }
    linear[MISS] = 1.0;
    let mut all = linear;
    for (slope, unknown) in slopes.iter().zip(&solution[MODES..]) {
        for &(column, weight) in slope {
            all[column] -= unknown * weight;
        }
    }
    [all, linear]
}

/// Sum of squares of each mode's part of the deformation.
fn energies(pair: &Pair, linear: &[f64; UNKNOWNS]) -> [f64; 2] {
    let shares = shares(linear);
    core::array::from_fn(|mode| {
        let first = mode * OF_A_MODE;
        let weights = [
            (first + FREE, linear[2 * mode]),
            (first + FREE + 1, linear[2 * mode + 1]),
            (first + RATE_COLUMN, linear[RATES[mode]]),
            // The second mode's column is its deformation less the first's.
            (SHAPE_COLUMN, shares[mode]),
            (OF_A_MODE + SHAPE_COLUMN, mode as f64 * shares[mode]),
        ];
        pair.square(&weights)
    })
}

/// One step of all unknowns; `damping` as in Levenberg and Marquardt's method. An infinite damping holds `ln w`
/// or `xi`.
pub fn fit(pair: &Pair, priors: &Priors, variance: f64, damping: &[f64; 4]) -> Option<Fit> {
    let mut profile = solve_linear(pair, priors, variance)?;
    let linear = profile.factor.backward::<MODES>(&profile.forward);
    let slopes = slopes(pair, &linear);
    add_modes(pair, (priors, variance), damping, &slopes, &mut profile)?;
    let Profile {
        factor,
        forward,
        cost,
    } = profile;
    let solution = factor.backward::<UNKNOWNS>(&forward);
    let gained: f64 = (MODES..UNKNOWNS)
        .map(|n| factor.explained(&forward, n))
        .sum();
    let [residual, linear_residual] = residuals(&solution, &slopes);
    let share = |i: usize| 1.0 - (variance * priors.precision[i] / factor.diagonal(i)).min(1.0);
    Some(Fit {
        cost,
        cost_after: cost - gained,
        step: core::array::from_fn(|n| solution[MODES + n]),
        covariance: core::array::from_fn(|i| {
            core::array::from_fn(|j| factor.inverse_of(MODES + i, MODES + j))
        }),
        gain: (solution[GAIN], factor.inverse(GAIN)),
        shares: relative(&linear),
        residual,
        linear_residual,
        unknowns: (0..UNKNOWNS).map(share).sum(),
        energy: energies(pair, &linear),
    })
}

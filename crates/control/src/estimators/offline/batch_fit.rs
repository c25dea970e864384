//! The batch fit: least squares of the output error over a whole record.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::SMatrix;
use quell_shapers::Mode;

use super::output_error::Problem;
use super::point::{Point, UNKNOWNS, damping_slope, point_of};
use super::search::{best_start, descend};
use crate::estimators::{Sample, Settings};

/// Relative increase of each diagonal element before the normal equations are inverted: a few hundred
/// roundings. So unknowns that the record does not separate also have a standard deviation, three million times
/// that of each with the others known.
const ROUNDING: f64 = 1e-13;

/// The result of a batch fit.
#[derive(Clone, Debug, PartialEq)]
pub struct BatchFit {
    /// The mode.
    pub mode: Mode,
    /// One standard deviation of `omega_n`, rad/s.
    pub natural_frequency_std: f64,
    /// One standard deviation of `xi`.
    pub damping_ratio_std: f64,
    /// Static gain and its standard deviation.
    pub gain: (f64, f64),
    /// Scale of the deformation relative to the response to the motor side's motion.
    pub scale: f64,
    /// Constant offset of the deformation.
    pub offset: f64,
    /// Vibration at the first sample: amplitudes of `Re e^(lambda t)` and `Im e^(lambda t)`.
    pub free: [f64; 2],
    /// Standard deviation of the residual.
    pub residual_std: f64,
    /// First autocorrelation of the residual; white noise leaves about 0.
    pub correlation: f64,
    /// Residual at every sample.
    pub residual: Vec<f64>,
}

/// Least squares of the output error over all samples, by Levenberg and Marquardt's method.
///
/// The model is that of the likelihood estimator. The initial state is free (again after each `memory` of the
/// settings); offset, rate, scale and gain are further unknowns under the settings' priors. Starts: a grid of
/// frequencies over the settings' range, a quarter apart; the best end wins. For a record of more than 1e4
/// samples all starts are first fitted to the 1e4 samples of highest energy. Their ends are then fitted to the
/// 1e5 samples of highest energy (or all, if there are fewer), and the best of these starts the fit to the
/// whole record. With `motion` false the motor side is taken as standing still (a plain free decay). `None`
/// where no start ends in a mode or the samples are fewer than twice the unknowns.
pub fn batch_fit(samples: &[Sample], settings: &Settings, motion: bool) -> Option<BatchFit> {
    if samples.len() < 2 * (UNKNOWNS + 2) {
        return None;
    }
    if motion {
        return follow(samples, settings, best_start(samples, settings)?);
    }
    let stand = |s: &Sample| Sample {
        motor_position: 0.0,
        ..*s
    };
    let still: Vec<Sample> = samples.iter().map(stand).collect();
    follow(&still, settings, best_start(&still, settings)?)
}

/// The batch fit from a known mode, on a part of a record that [`batch_fit`] accepted, so that it has enough
/// samples. `None` where it ends in no mode of the settings' range.
pub fn batch_fit_near(samples: &[Sample], settings: &Settings, mode: Mode) -> Option<BatchFit> {
    let point = point_of(mode.natural_frequency(), mode.damping_ratio());
    follow(samples, settings, point)
}

/// Descends from a point to rounding, over all samples.
fn follow(samples: &[Sample], settings: &Settings, point: Point) -> Option<BatchFit> {
    let (end, _) = descend(&LevenbergMarquardt::new(), samples, settings, point)?;
    conclude(&end)
}

/// Statistics at the end of a descent.
fn conclude(problem: &Problem<'_>) -> Option<BatchFit> {
    let mode = problem.mode()?;
    let count = problem.samples.len();
    let residual = problem.residual(mode);
    let square: f64 = residual.iter().map(|r| r * r).sum();
    let product: f64 = residual.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let correlation = if square > 0.0 { product / square } else { 0.0 };
    let unknowns = UNKNOWNS + 2 * problem.stretches();
    let variance = square / (count.saturating_sub(unknowns).max(1)) as f64;
    // Two standard deviations of the first autocorrelation of white noise. At least one of all samples is
    // independent.
    let wide = if correlation > 2.0 / (count as f64).sqrt() {
        ((1.0 + correlation) / (1.0 - correlation)).min(count as f64)
    } else {
        1.0
    };
    let std = standard_deviations(problem, variance * wide)?;
    Some(BatchFit {
        mode,
        natural_frequency_std: std[0] * mode.natural_frequency(),
        damping_ratio_std: std[1] * damping_slope(&problem.point).abs(),
        gain: (problem.point[5], std[5]),
        scale: 1.0 + problem.point[4],
        offset: problem.point[2],
        free: problem.first_free(),
        residual_std: variance.sqrt(),
        correlation,
        residual,
    })
}

/// Standard deviations of the unknowns for a variance of the residual.
fn standard_deviations(problem: &Problem<'_>, variance: f64) -> Option<[f64; UNKNOWNS]> {
    let jacobian = problem.jacobian()?;
    let normal = jacobian.tr_mul(&jacobian);
    let scale: [f64; UNKNOWNS] =
        core::array::from_fn(|k| normal[(k, k)].max(f64::MIN_POSITIVE).sqrt());
    let scaled = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|i, j| {
        normal[(i, j)] / (scale[i] * scale[j]) + if i == j { ROUNDING } else { 0.0 }
    });
    let inverse = scaled.cholesky()?.inverse();
    Some(core::array::from_fn(|k| match problem.is_held(k) {
        true => 0.0,
        false => (inverse[(k, k)] * variance).sqrt() / scale[k],
    }))
}

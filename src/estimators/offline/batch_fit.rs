//! The batch fit: least squares of the output error over a whole record.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::SMatrix;
use quell_shapers::Mode;

use super::output_error::{Point, Problem, UNKNOWNS};
use crate::estimators::{Sample, Settings};

/// Samples in which the starts are told apart. The end of 1e7 samples is a hundred times as far: with noise
/// of a tenth of the amplitude the phase there of what never decays is known from 1e5 to
/// `0.1 sqrt(24 / 1e5) 100 = 0.15` rad, which is in the minimum of the whole.
const ENOUGH: usize = 100_000;

/// Relative change of the cost, and of the unknowns, at which a search from a start ends: two minima that
/// are nearer are one. The best is then followed down to rounding.
const SEARCH: f64 = 1e-6;

/// What a batch fit found.
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
    /// Scale of the deformation against what the motor side's motion makes of it.
    pub scale: f64,
    /// Constant offset of the deformation.
    pub offset: f64,
    /// Standard deviation of the residual.
    pub residual_std: f64,
    /// First autocorrelation of the residual; white noise leaves about 0.
    pub correlation: f64,
    /// Residual at every sample.
    pub residual: Vec<f64>,
}

/// Least squares of the output error over all samples, by Levenberg and Marquardt's method.
///
/// The model is that of the likelihood estimator, with the free initial state (again after each
/// `memory` of the settings), offset, rate, scale and gain as further unknowns under the settings'
/// priors. Starts: a grid of frequencies over the settings' range, a quarter apart; the best end wins. In
/// a record of more than 1e5 samples that is decided in the liveliest so many of them, and where it ends
/// there the whole begins. With `motion` false the motor side counts as standing still (a plain free
/// decay). `None` where no start ends in a mode or the samples are fewer than twice the unknowns.
pub fn batch_fit(samples: &[Sample], settings: &Settings, motion: bool) -> Option<BatchFit> {
    if samples.len() < 2 * (UNKNOWNS + 2) {
        return None;
    }
    let still: Vec<Sample>;
    let samples = if motion {
        samples
    } else {
        still = samples
            .iter()
            .map(|s| Sample {
                motor_position: 0.0,
                ..*s
            })
            .collect();
        &still
    };
    let (low, high) = settings.frequency_range;
    let inside = |solved: &(Problem, f64)| {
        let w = solved.0.point[0].exp();
        w >= 0.8 * low && w <= 1.25 * high
    };
    let intervals = ((high / low).ln() / 1.25_f64.ln()).ceil().clamp(1.0, 40.0) as usize;
    let part = liveliest(samples);
    let search = LevenbergMarquardt::new().with_tol(SEARCH);
    let (found, _) = (0..=intervals)
        .map(|k| low * (high / low).powf(k as f64 / intervals as f64))
        .filter_map(|w| solve(&search, part, settings, start(settings, w)))
        .filter(inside)
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let exact = LevenbergMarquardt::new();
    let (end, _) = solve(&exact, samples, settings, found.point).filter(inside)?;
    conclude(&end)
}

/// Of more samples than tell the starts apart those in a row whose deformation varies most.
fn liveliest(samples: &[Sample]) -> &[Sample] {
    let variance = |part: &[Sample]| {
        let n = part.len() as f64;
        let mean = part.iter().map(|s| s.deformation).sum::<f64>() / n;
        part.iter()
            .map(|s| (s.deformation - mean).powi(2))
            .sum::<f64>()
            / n
    };
    let parts = samples.chunks_exact(ENOUGH);
    parts
        .max_by(|a, b| variance(a).total_cmp(&variance(b)))
        .unwrap_or(samples)
}

/// A start at the frequency `w`.
fn start(settings: &Settings, w: f64) -> Point {
    let mut point = Point::zeros();
    point[0] = w.ln();
    point[1] = settings
        .belief
        .map_or(0.05, |mode| mode.damping_ratio())
        .clamp(0.005, 0.3);
    point
}

/// One descent from a start.
fn solve<'a>(
    method: &LevenbergMarquardt<f64>,
    samples: &'a [Sample],
    settings: &'a Settings,
    point: Point,
) -> Option<(Problem<'a>, f64)> {
    let mean = samples.iter().map(|s| s.deformation).sum::<f64>() / samples.len() as f64;
    let amplitude = samples
        .iter()
        .map(|s| (s.deformation - mean).abs())
        .fold(0.0, f64::max);
    let noise = settings.noise_std.unwrap_or(0.01 * amplitude);
    let problem = Problem::new(samples, settings, noise, point);
    let (problem, report) = method.with_patience(20).minimize(problem);
    (report.objective_function.is_finite() && problem.mode().is_some())
        .then_some((problem, report.objective_function))
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
    let rho = correlation.clamp(0.0, 0.999);
    let wide = if rho > 2.0 / (count as f64).sqrt() {
        (1.0 + rho) / (1.0 - rho)
    } else {
        1.0
    };
    let jacobian = problem.jacobian()?;
    let normal = jacobian.tr_mul(&jacobian);
    let scale: Vec<f64> = (0..UNKNOWNS)
        .map(|k| normal[(k, k)].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let scaled = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::from_fn(|i, j| {
        normal[(i, j)] / (scale[i] * scale[j]) + if i == j { 1e-13 } else { 0.0 }
    });
    let inverse = scaled.cholesky()?.inverse();
    let std = |k: usize| (inverse[(k, k)] * variance * wide).sqrt() / scale[k];
    Some(BatchFit {
        mode,
        natural_frequency_std: std(0) * mode.natural_frequency(),
        damping_ratio_std: std(1) * problem.damping_slope().abs(),
        gain: (problem.point[5], std(5)),
        scale: 1.0 + problem.point[4],
        offset: problem.point[2],
        residual_std: variance.sqrt(),
        correlation,
        residual,
    })
}

//! The batch fit: least squares of the output error over a whole record.

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{DMatrix, DVector, Dyn, Matrix, Owned, U1, U8, Vector};
use quell_shapers::Mode;

use crate::estimators::modal_response::{
    DEFORMATION, FREE, FREE_SLOPE, INPUT, Interval, LINK, ModalResponse, OFFSET, RATE, RESIDUAL,
    VELOCITY, WIDTH,
};
use crate::estimators::{Sample, Settings};

/// Unknowns: `ln w`, `sqrt(xi / (1 - xi))`, the free decay (two), offset, rate, scale, gain.
const UNKNOWNS: usize = 8;
/// The columns of the six linear ones.
const LINEAR: [usize; 6] = [FREE, FREE + 1, OFFSET, VELOCITY, DEFORMATION, INPUT];

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
    /// Constant offset of the deformation.
    pub offset: f64,
    /// Standard deviation of the residual.
    pub residual_std: f64,
    /// First autocorrelation of the residual; white noise leaves about 0.
    pub correlation: f64,
    /// Residual at every sample.
    pub residual: Vec<f64>,
}

struct Problem<'a> {
    samples: &'a [Sample],
    settings: &'a Settings,
    /// Residual that a prior's standard deviation is worth.
    noise: f64,
    amplitude: f64,
    point: Vector<f64, U8, Owned<f64, U8>>,
    rows: Vec<[f64; WIDTH]>,
    slopes: [nalgebra::Complex<f64>; 2],
}

impl Problem<'_> {
    /// The mode at the point: `w = exp p_0`, `xi = p_1^2 / (1 + p_1^2)`, so that every step of the
    /// solver ends in a mode.
    fn mode(&self) -> Option<Mode> {
        let square = self.point[1] * self.point[1];
        // Within what doubles can simulate; a frequency out there is refused later.
        Mode::new(
            self.point[0].clamp(-20.0, 20.0).exp(),
            (square / (1.0 + square)).min(0.999),
        )
        .ok()
    }

    fn simulate(&mut self) {
        self.rows.clear();
        let Some(mode) = self.mode() else { return };
        let mut response = ModalResponse::new(mode, self.settings.sample_time);
        self.slopes = response.lambda_slopes();
        let origin = self.samples.first().map_or(0.0, |s| s.motor_position);
        for (k, sample) in self.samples.iter().enumerate() {
            if k > 0 {
                let last = self.samples[k - 1];
                let before = if k > 1 { self.samples[k - 2] } else { last };
                response.advance(&Interval {
                    start: last.motor_position - origin,
                    end: sample.motor_position - origin,
                    step: sample.time - last.time,
                    before: before.motor_position - origin,
                    step_before: last.time - before.time,
                });
            }
            self.rows
                .push(response.row(sample.motor_position - origin, sample.deformation));
        }
    }

    /// One residual's worth of each prior: rate, scale, gain and offset.
    fn priors(&self) -> [f64; UNKNOWNS] {
        let weight = |std: f64| {
            if std > 0.0 {
                self.noise / std
            } else {
                1e6 * self.noise
            }
        };
        let w = self.point[0].exp();
        let amplitude = weight(10.0 * self.amplitude);
        [
            0.0,
            0.0,
            amplitude,
            amplitude,
            self.settings.offset_std.map_or(1.0, weight),
            weight(1.0 / w),
            weight(self.settings.scale_std),
            weight(self.settings.gain_std),
        ]
    }

    fn derivatives(&self, row: &[f64; WIDTH]) -> [f64; UNKNOWNS] {
        let [_, _, a, b, _, rate, scale, _] = core::array::from_fn(|k| self.point[k]);
        let mut derivative = [0.0; UNKNOWNS];
        for k in 0..2 {
            let turned = nalgebra::Complex::new(a, -b) * self.slopes[k];
            derivative[k] =
                (1.0 + scale) * row[LINK + k] + rate * row[RATE + k] + turned.re * row[FREE_SLOPE]
                    - turned.im * row[FREE_SLOPE + 1];
        }
        derivative[1] *= 2.0 * self.point[1] / (1.0 + self.point[1] * self.point[1]).powi(2);
        for (k, &column) in LINEAR.iter().enumerate() {
            derivative[k + 2] = row[column];
        }
        derivative
    }
}

impl LeastSquaresProblem<f64, Dyn, U8> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn, U1>;
    type JacobianStorage = Owned<f64, Dyn, U8>;
    type ParameterStorage = Owned<f64, U8>;

    fn set_params(&mut self, point: &Vector<f64, U8, Self::ParameterStorage>) {
        self.point.copy_from(point);
        self.simulate();
    }

    fn params(&self) -> Vector<f64, U8, Self::ParameterStorage> {
        self.point
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.mode()?;
        let priors = self.priors();
        let data = self.rows.iter().map(|row| {
            LINEAR
                .iter()
                .enumerate()
                .map(|(k, &c)| self.point[k + 2] * row[c])
                .sum::<f64>()
                - row[RESIDUAL]
        });
        let prior = (0..UNKNOWNS).map(|k| priors[k] * self.point[k]);
        let all: Vec<f64> = data.chain(prior).collect();
        all.iter()
            .all(|value| value.is_finite())
            .then(|| DVector::from_vec(all))
    }

    fn jacobian(&self) -> Option<Matrix<f64, Dyn, U8, Self::JacobianStorage>> {
        let count = self.rows.len();
        let mut jacobian = Matrix::<f64, Dyn, U8, Self::JacobianStorage>::zeros(count + UNKNOWNS);
        for (i, row) in self.rows.iter().enumerate() {
            for (k, value) in self.derivatives(row).into_iter().enumerate() {
                jacobian[(i, k)] = value;
            }
        }
        for (k, value) in self.priors().into_iter().enumerate() {
            jacobian[(count + k, k)] = value;
        }
        Some(jacobian)
    }
}

/// Least squares of the output error over all samples, by Levenberg and Marquardt's method.
///
/// The model is that of the likelihood estimator, with the free initial state, offset, rate, scale
/// and gain as further unknowns under the settings' priors. Starts: a grid of frequencies over the
/// settings' range, a quarter apart; the best end wins. With `motion` false the motor side counts
/// as standing still (a plain free decay). `None` where no start ends in a mode or the samples are
/// fewer than twice the unknowns.
pub fn batch_fit(samples: &[Sample], settings: &Settings, motion: bool) -> Option<BatchFit> {
    if samples.len() < 2 * UNKNOWNS {
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
    let intervals = ((high / low).ln() / 1.25_f64.ln()).ceil().clamp(1.0, 40.0) as usize;
    (0..=intervals)
        .filter_map(|k| {
            let w = low * (high / low).powf(k as f64 / intervals as f64);
            solve(samples, settings, w)
        })
        .filter(|(problem, _)| {
            let w = problem.point[0].exp();
            w >= 0.8 * low && w <= 1.25 * high
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .and_then(|(problem, _)| conclude(&problem))
}

/// One descent from a start at the frequency `w`.
fn solve<'a>(samples: &'a [Sample], settings: &'a Settings, w: f64) -> Option<(Problem<'a>, f64)> {
    let mean = samples.iter().map(|s| s.deformation).sum::<f64>() / samples.len() as f64;
    let amplitude = samples
        .iter()
        .map(|s| (s.deformation - mean).abs())
        .fold(0.0, f64::max);
    let noise = settings.noise_std.unwrap_or(0.01 * amplitude);
    let mut point = Vector::<f64, U8, Owned<f64, U8>>::zeros();
    point[0] = w.ln();
    point[1] = settings
        .belief
        .map_or(0.05, |mode| mode.damping_ratio())
        .clamp(0.005, 0.3);
    let mut problem = Problem {
        samples,
        settings,
        noise,
        amplitude,
        point,
        rows: Vec::with_capacity(samples.len()),
        slopes: [nalgebra::Complex::new(0.0, 0.0); 2],
    };
    problem.simulate();
    let (problem, report) = LevenbergMarquardt::new()
        .with_patience(20)
        .minimize(problem);
    (report.objective_function.is_finite() && problem.mode().is_some())
        .then_some((problem, report.objective_function))
}

/// Statistics at the end of a descent.
fn conclude(problem: &Problem<'_>) -> Option<BatchFit> {
    let mode = problem.mode()?;
    let count = problem.rows.len();
    let residual: Vec<f64> = problem.residuals()?.iter().take(count).copied().collect();
    let square: f64 = residual.iter().map(|r| r * r).sum();
    let product: f64 = residual.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let correlation = if square > 0.0 { product / square } else { 0.0 };
    let variance = square / (count.saturating_sub(UNKNOWNS).max(1)) as f64;
    let rho = correlation.clamp(0.0, 0.999);
    let wide = if rho > 2.0 / (count as f64).sqrt() {
        (1.0 + rho) / (1.0 - rho)
    } else {
        1.0
    };
    let mut normal = DMatrix::<f64>::zeros(UNKNOWNS, UNKNOWNS);
    let jacobian = problem.jacobian()?;
    normal += jacobian.transpose() * &jacobian;
    let scale: Vec<f64> = (0..UNKNOWNS)
        .map(|k| normal[(k, k)].max(f64::MIN_POSITIVE).sqrt())
        .collect();
    let scaled = DMatrix::from_fn(UNKNOWNS, UNKNOWNS, |i, j| {
        normal[(i, j)] / (scale[i] * scale[j]) + if i == j { 1e-13 } else { 0.0 }
    });
    let inverse = scaled.cholesky()?.inverse();
    let std = |k: usize| (inverse[(k, k)] * variance * wide).sqrt() / scale[k];
    Some(BatchFit {
        mode,
        natural_frequency_std: std(0) * mode.natural_frequency(),
        damping_ratio_std: std(1) * 2.0 * problem.point[1]
            / (1.0 + problem.point[1] * problem.point[1]).powi(2),
        gain: (problem.point[7], std(7)),
        offset: problem.point[4],
        residual_std: variance.sqrt(),
        correlation,
        residual: residual.iter().map(|r| -r).collect(),
    })
}

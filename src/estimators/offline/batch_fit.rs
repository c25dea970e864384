//! The batch fit: least squares of the output error over a whole record.

use core::ops::Range;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{
    Complex, DMatrix, DVector, Dyn, Matrix, Matrix2, Owned, SMatrix, U1, U6, Vector, Vector2,
};
use quell_shapers::Mode;

use crate::estimators::modal_response::{
    DEFORMATION, FREE, FREE_SLOPE, INPUT, Interval, LINK, ModalResponse, OFFSET, RATE, RESIDUAL,
    VELOCITY, WIDTH,
};
use crate::estimators::{Sample, Settings};

/// Unknowns of the solver: `ln w`, `sqrt(xi / (1 - xi))`, offset, rate, scale, gain. The free decay of
/// each stretch is projected out.
const UNKNOWNS: usize = 6;
/// The columns of the four linear ones.
const LINEAR: [usize; 4] = [OFFSET, VELOCITY, DEFORMATION, INPUT];

type Point = Vector<f64, U6, Owned<f64, U6>>;

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

struct Problem<'a> {
    samples: &'a [Sample],
    settings: &'a Settings,
    /// Residual that a prior's standard deviation is worth.
    noise: f64,
    point: Point,
    rows: Vec<[f64; WIDTH]>,
    stretches: Vec<Stretch>,
    slopes: [Complex<f64>; 2],
}

/// Samples over which the vibration is that of one free initial state.
struct Stretch {
    range: Range<usize>,
    /// Inverse of the free columns' normal matrix.
    inverse: Matrix2<f64>,
    /// Amplitudes of the free columns.
    free: Vector2<f64>,
}

impl Problem<'_> {
    /// The mode at the point: `w = exp p_0`, `xi = p_1^2 / (1 + p_1^2)`, so that every step of the
    /// solver ends in a mode.
    fn mode(&self) -> Option<Mode> {
        let square = self.point[1] * self.point[1];
        // Within what doubles can simulate; a frequency out there is refused later.
        let w = self.point[0].clamp(-20.0, 20.0).exp();
        Mode::new(w, (square / (1.0 + square)).min(0.999)).ok()
    }

    fn simulate(&mut self) {
        self.rows.clear();
        self.stretches.clear();
        let Some(mode) = self.mode() else { return };
        let mut response = ModalResponse::new(mode, self.settings.sample_time);
        self.slopes = response.lambda_slopes();
        let mut first = 0;
        for (k, sample) in self.samples.iter().enumerate() {
            let begins = sample.time - self.samples[first].time >= self.settings.memory;
            if begins {
                self.close(first..k);
                first = k;
                response.restart();
            } else if k > 0 {
                let interval = interval(self.samples, first, k);
                response.advance(interval.step, &interval.parabola());
            }
            let origin = self.samples[first].motor_position;
            let mut row = response.row(sample.motor_position - origin, sample.deformation);
            row[INPUT] = sample.motor_position - self.samples[0].motor_position;
            self.rows.push(row);
        }
        self.close(first..self.samples.len());
    }

    /// Ends a stretch: its free decay is solved for the linear unknowns as they are.
    fn close(&mut self, range: Range<usize>) {
        let mut normal = Matrix2::zeros();
        let mut rhs = Vector2::zeros();
        for row in &self.rows[range.clone()] {
            let columns = Vector2::new(row[FREE], row[FREE + 1]);
            normal += columns * columns.transpose();
            rhs += columns * (row[RESIDUAL] - self.linear(row));
        }
        // One sample alone determines one amplitude: the rest of the other is left at zero.
        normal += Matrix2::identity() * (1e-12 * normal.trace());
        let inverse = normal.try_inverse().unwrap_or_else(Matrix2::zeros);
        self.stretches.push(Stretch {
            range,
            inverse,
            free: inverse * rhs,
        });
    }

    fn linear(&self, row: &[f64; WIDTH]) -> f64 {
        LINEAR
            .iter()
            .enumerate()
            .map(|(k, &column)| self.point[k + 2] * row[column])
            .sum()
    }

    /// One residual's worth of each prior: offset, rate, scale, gain.
    fn priors(&self) -> [f64; UNKNOWNS] {
        let weight = |std: f64| {
            if std > 0.0 {
                self.noise / std
            } else {
                1e6 * self.noise
            }
        };
        let w = self.point[0].exp();
        [
            0.0,
            0.0,
            self.settings.offset_std.map_or(1.0, weight),
            weight(1.0 / w),
            weight(self.settings.scale_std),
            weight(self.settings.gain_std),
        ]
    }

    fn derivatives(&self, row: &[f64; WIDTH], free: &Vector2<f64>) -> [f64; UNKNOWNS] {
        let (rate, scale) = (self.point[3], self.point[4]);
        let mut derivative = [0.0; UNKNOWNS];
        for k in 0..2 {
            let turned = Complex::new(free.x, -free.y) * self.slopes[k];
            derivative[k] =
                (1.0 + scale) * row[LINK + k] + rate * row[RATE + k] + turned.re * row[FREE_SLOPE]
                    - turned.im * row[FREE_SLOPE + 1];
        }
        derivative[1] *= self.damping_slope();
        for (k, &column) in LINEAR.iter().enumerate() {
            derivative[k + 2] = row[column];
        }
        derivative
    }

    /// `d xi / d p_1`.
    fn damping_slope(&self) -> f64 {
        2.0 * self.point[1] / (1.0 + self.point[1] * self.point[1]).powi(2)
    }

    /// Model minus data at every sample.
    fn errors(&self) -> impl Iterator<Item = f64> + '_ {
        self.stretches.iter().flat_map(move |stretch| {
            self.rows[stretch.range.clone()].iter().map(move |row| {
                self.linear(row) + stretch.free.x * row[FREE] + stretch.free.y * row[FREE + 1]
                    - row[RESIDUAL]
            })
        })
    }
}

/// The interval that ends at sample `k` of the stretch that begins at `first`.
fn interval(samples: &[Sample], first: usize, k: usize) -> Interval {
    let origin = samples[first].motor_position;
    let last = samples[k - 1];
    let before = if k > 1 { samples[k - 2] } else { last };
    Interval {
        start: last.motor_position - origin,
        end: samples[k].motor_position - origin,
        step: samples[k].time - last.time,
        before: before.motor_position - origin,
        step_before: last.time - before.time,
    }
}

impl LeastSquaresProblem<f64, Dyn, U6> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn, U1>;
    type JacobianStorage = Owned<f64, Dyn, U6>;
    type ParameterStorage = Owned<f64, U6>;

    fn set_params(&mut self, point: &Point) {
        self.point.copy_from(point);
        self.simulate();
    }

    fn params(&self) -> Point {
        self.point
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let priors = self.priors();
        let prior = (0..UNKNOWNS).map(|k| priors[k] * self.point[k]);
        let all: Vec<f64> = self.errors().chain(prior).collect();
        all.iter()
            .all(|value| value.is_finite())
            .then(|| DVector::from_vec(all))
    }

    /// Derivatives, with what the free decays of each stretch can follow projected out.
    ///
    /// Source: L. Kaufman, A variable projection method for solving separable nonlinear least squares
    /// problems, BIT 15 (1975).
    fn jacobian(&self) -> Option<Matrix<f64, Dyn, U6, Self::JacobianStorage>> {
        let count = self.rows.len();
        let mut jacobian = Matrix::<f64, Dyn, U6, Self::JacobianStorage>::zeros(count + UNKNOWNS);
        for stretch in &self.stretches {
            let mut products = SMatrix::<f64, 2, UNKNOWNS>::zeros();
            for i in stretch.range.clone() {
                let row = &self.rows[i];
                for (k, value) in self.derivatives(row, &stretch.free).into_iter().enumerate() {
                    jacobian[(i, k)] = value;
                    products[(0, k)] += row[FREE] * value;
                    products[(1, k)] += row[FREE + 1] * value;
                }
            }
            let followed = stretch.inverse * products;
            for i in stretch.range.clone() {
                let row = &self.rows[i];
                for k in 0..UNKNOWNS {
                    jacobian[(i, k)] -=
                        row[FREE] * followed[(0, k)] + row[FREE + 1] * followed[(1, k)];
                }
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
/// The model is that of the likelihood estimator, with the free initial state (again after each
/// `memory` of the settings), offset, rate, scale and gain as further unknowns under the settings' priors. Starts: a grid of frequencies over the
/// settings' range, a quarter apart; the best end wins. With `motion` false the motor side counts
/// as standing still (a plain free decay). `None` where no start ends in a mode or the samples are
/// fewer than twice the unknowns.
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
    let mut point = Point::zeros();
    point[0] = w.ln();
    point[1] = settings
        .belief
        .map_or(0.05, |mode| mode.damping_ratio())
        .clamp(0.005, 0.3);
    let mut problem = Problem {
        samples,
        settings,
        noise,
        point,
        rows: Vec::with_capacity(samples.len()),
        stretches: Vec::new(),
        slopes: [Complex::new(0.0, 0.0); 2],
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
    let residual: Vec<f64> = problem.errors().collect();
    let square: f64 = residual.iter().map(|r| r * r).sum();
    let product: f64 = residual.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let correlation = if square > 0.0 { product / square } else { 0.0 };
    let unknowns = UNKNOWNS + 2 * problem.stretches.len();
    let variance = square / (count.saturating_sub(unknowns).max(1)) as f64;
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
        damping_ratio_std: std(1) * problem.damping_slope().abs(),
        gain: (problem.point[5], std(5)),
        scale: 1.0 + problem.point[4],
        offset: problem.point[2],
        residual_std: variance.sqrt(),
        correlation,
        residual: residual.iter().map(|r| -r).collect(),
    })
}

//! The output error as a least-squares problem.
//!
//! At every point one pass over the record is made. Only a triangular factor of its rows is kept, which
//! contains all products of the columns: memory does not grow with the record.

use core::ops::Range;

use levenberg_marquardt::LeastSquaresProblem;
use nalgebra::{Complex, Const, OMatrix, Owned, RowSVector, SMatrix, SVector, U1, U6, Vector2};
use quell_shapers::Mode;

use super::point::{Point, UNKNOWNS, damping_slope, mode};
use super::triangle::Triangle;
use crate::estimators::modal_response::{
    DEFORMATION, FREE, FREE_SLOPE, INPUT, Interval, LINK, ModalResponse, OFFSET, RATE, RESIDUAL,
    VELOCITY, WIDTH,
};
use crate::estimators::{Sample, Settings};

/// The columns of the four linear ones.
const LINEAR: [usize; 4] = [OFFSET, VELOCITY, DEFORMATION, INPUT];
/// Columns of a stretch: two of the free decay, two sensitivities of the link, two of the free decay, the
/// linear ones, the residual.
const COLUMNS: usize = 11;
/// Derivatives and residual.
const REDUCED: usize = UNKNOWNS + 1;
/// Residuals of the solver: the triangle's, a prior each.
const ROWS: usize = REDUCED + UNKNOWNS;

/// Noise, in amplitudes of the deformation, if its level is not given. It weighs the priors only: for `N`
/// samples of a vibration a scale known to 10 % has a relative weight of `0.02 / N`, so that its order of
/// magnitude is enough.
const GUESSED_NOISE: f64 = 0.01;
/// One record, and a point in the space of unknowns.
pub struct Problem<'a> {
    pub samples: &'a [Sample],
    settings: &'a Settings,
    /// Residual that corresponds to one standard deviation of a prior.
    noise: f64,
    pub point: Point,
    stretches: Vec<Stretch>,
    /// Triangle of derivatives and residual over all stretches, their free decays projected out.
    reduced: SMatrix<f64, REDUCED, REDUCED>,
    slopes: [Complex<f64>; 2],
}

/// Samples whose vibration has one free initial state.
struct Stretch {
    range: Range<usize>,
    /// Amplitudes of the free columns.
    free: Vector2<f64>,
}

impl<'a> Problem<'a> {
    /// The problem for a record, settings and a point.
    pub fn new(samples: &'a [Sample], settings: &'a Settings, point: Point) -> Self {
        let mut problem = Self {
            samples,
            settings,
            noise: settings
                .noise_std
                .unwrap_or_else(|| GUESSED_NOISE * amplitude(samples)),
            point,
            stretches: Vec::new(),
            reduced: SMatrix::zeros(),
            slopes: [Complex::new(0.0, 0.0); 2],
        };
        problem.simulate();
        problem
    }

    /// How many free decays there are.
    pub fn stretches(&self) -> usize {
        self.stretches.len()
    }

    /// Amplitudes of the first stretch's free decay.
    pub fn first_free(&self) -> [f64; 2] {
        self.stretches
            .first()
            .map_or([0.0; 2], |stretch| stretch.free.into())
    }

    /// The mode at the point.
    pub fn mode(&self) -> Option<Mode> {
        mode(&self.point, self.settings.frequency_range)
    }

    fn simulate(&mut self) {
        self.stretches.clear();
        self.reduced.fill(f64::NAN);
        let Some(mode) = self.mode() else { return };
        self.slopes = ModalResponse::new(mode, self.settings.sample_time).lambda_slopes();
        let mut stretch = Triangle::<COLUMNS>::new();
        let mut all = Triangle::<REDUCED>::new();
        let (mut stretches, mut first) = (Vec::new(), 0);
        let mut close = |range, triangle| {
            let free = self.free(&triangle);
            self.reduce(&triangle, &free, &mut all);
            stretches.push(Stretch { range, free });
        };
        self.walk(mode, |k, begins, row| {
            if begins && k > 0 {
                close(first..k, stretch.take());
                first = k;
            }
            stretch.push(&self.columns(row));
        });
        close(first..self.samples.len(), stretch.take());
        self.reduced = all.take();
        self.stretches = stretches;
    }

    /// Visits every sample's row, and whether a stretch begins with it.
    fn walk(&self, mode: Mode, mut see: impl FnMut(usize, bool, &[f64; WIDTH])) {
        let mut response = ModalResponse::new(mode, self.settings.sample_time);
        let mut first = 0;
        for (k, sample) in self.samples.iter().enumerate() {
            let begins = sample.time - self.samples[first].time >= self.settings.memory;
            if begins {
                first = k;
                response.restart();
            } else if k > 0 {
                let interval = interval(self.samples, first, k);
                response.advance(interval.step, &interval.parabola());
            }
            let origin = self.samples[first].motor_position;
            let mut row = response.row(sample.motor_position - origin, sample.deformation);
            row[INPUT] = sample.motor_position - self.samples[0].motor_position;
            see(k, begins, &row);
        }
    }

    /// A row in the order of [`COLUMNS`].
    fn columns(&self, row: &[f64; WIDTH]) -> [f64; COLUMNS] {
        let (rate, scale) = (self.point[3], self.point[4]);
        let link = |k: usize| (1.0 + scale) * row[LINK + k] + rate * row[RATE + k];
        let [offset, velocity, deformation, input] = LINEAR.map(|column| row[column]);
        [
            row[FREE],
            row[FREE + 1],
            link(0),
            link(1),
            row[FREE_SLOPE],
            row[FREE_SLOPE + 1],
            offset,
            velocity,
            deformation,
            input,
            row[RESIDUAL],
        ]
    }

    /// Amplitudes of a stretch's free decay for the present linear unknowns.
    fn free(&self, triangle: &SMatrix<f64, COLUMNS, COLUMNS>) -> Vector2<f64> {
        let linear = triangle.fixed_view::<2, 4>(0, 6) * self.point.fixed_rows::<4>(2);
        let left = triangle.fixed_view::<2, 1>(0, 10) - linear;
        // A single sample determines one amplitude only: the other column is 0, and so is its amplitude.
        let sine = match triangle[(1, 1)] {
            0.0 => 0.0,
            pivot => left[1] / pivot,
        };
        Vector2::new((left[0] - triangle[(0, 1)] * sine) / triangle[(0, 0)], sine)
    }

    /// Derivatives and residual of a stretch, with its free decay projected out: the rows of the triangle below
    /// those of the free columns.
    ///
    /// Source: L. Kaufman, A variable projection method for solving separable nonlinear least squares
    /// problems, BIT 15 (1975).
    fn reduce(
        &self,
        triangle: &SMatrix<f64, COLUMNS, COLUMNS>,
        free: &Vector2<f64>,
        all: &mut Triangle<REDUCED>,
    ) {
        let turned = |k: usize| Complex::new(free.x, -free.y) * self.slopes[k];
        let turned = [turned(0), turned(1)];
        let held = self.prior_deviations().map(|std| std == 0.0);
        for i in 2..COLUMNS {
            let row: RowSVector<f64, COLUMNS> = triangle.row(i).into_owned();
            let mut reduced = [0.0; REDUCED];
            for (k, turned) in turned.iter().enumerate() {
                reduced[k] = row[2 + k] + turned.re * row[4] - turned.im * row[5];
            }
            reduced[1] *= damping_slope(&self.point);
            for k in (2..UNKNOWNS).filter(|&k| !held[k]) {
                reduced[k] = row[4 + k];
            }
            reduced[UNKNOWNS] = (2..UNKNOWNS)
                .map(|k| self.point[k] * reduced[k])
                .sum::<f64>()
                - row[10];
            all.push(&reduced);
        }
    }

    fn linear(&self, row: &[f64; WIDTH]) -> f64 {
        LINEAR
            .iter()
            .enumerate()
            .map(|(k, &column)| self.point[k + 2] * row[column])
            .sum()
    }

    /// Standard deviations of the priors; infinite without a prior, 0 for unknowns held at 0.
    fn prior_deviations(&self) -> [f64; UNKNOWNS] {
        let rate = self.mode().map(|mode| mode.natural_frequency().recip());
        [
            f64::INFINITY,
            f64::INFINITY,
            self.settings.offset_std.unwrap_or(self.noise),
            rate.unwrap_or(f64::INFINITY),
            self.settings.scale_std,
            self.settings.gain_std,
        ]
    }

    /// Whether an unknown is held at 0.
    pub fn is_held(&self, unknown: usize) -> bool {
        self.prior_deviations()[unknown] == 0.0
    }

    /// Residuals of the priors: offset, rate, scale, gain. A held unknown affects no other residual.
    fn priors(&self) -> [f64; UNKNOWNS] {
        self.prior_deviations().map(|std| match std {
            0.0 => 1.0,
            std => self.noise / std,
        })
    }

    /// Data minus model at every sample.
    pub fn residual(&self, mode: Mode) -> Vec<f64> {
        let mut residual = Vec::with_capacity(self.samples.len());
        let mut stretches = self.stretches.iter();
        let mut stretch = stretches.next();
        self.walk(mode, |k, _, row| {
            if stretch.is_some_and(|own| own.range.end == k) {
                stretch = stretches.next();
            }
            let free = stretch.map_or_else(Vector2::zeros, |own| own.free);
            let model = self.linear(row) + free.x * row[FREE] + free.y * row[FREE + 1];
            residual.push(row[RESIDUAL] - model);
        });
        residual
    }
}

/// The largest deviation of the deformation from its mean.
fn amplitude(samples: &[Sample]) -> f64 {
    let mean = samples.iter().map(|s| s.deformation).sum::<f64>() / samples.len() as f64;
    let off = samples.iter().map(|s| (s.deformation - mean).abs());
    off.fold(0.0, f64::max)
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

impl LeastSquaresProblem<f64, Const<ROWS>, U6> for Problem<'_> {
    type ResidualStorage = Owned<f64, Const<ROWS>, U1>;
    type JacobianStorage = Owned<f64, Const<ROWS>, U6>;
    type ParameterStorage = Owned<f64, U6>;

    fn set_params(&mut self, point: &Point) {
        self.point.copy_from(point);
        self.simulate();
    }

    fn params(&self) -> Point {
        self.point
    }

    /// The residuals in reduced form: of the same length as all residuals of samples and priors, and at the
    /// same angles to the derivatives.
    fn residuals(&self) -> Option<SVector<f64, ROWS>> {
        let priors = SVector::from(self.priors()).component_mul(&self.point);
        let mut all = SVector::<f64, ROWS>::zeros();
        all.fixed_rows_mut::<REDUCED>(0)
            .copy_from(&self.reduced.column(UNKNOWNS));
        all.fixed_rows_mut::<UNKNOWNS>(REDUCED).copy_from(&priors);
        all.iter().all(|value| value.is_finite()).then_some(all)
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Const<ROWS>, U6>> {
        let mut jacobian = OMatrix::<f64, Const<ROWS>, U6>::zeros();
        jacobian
            .fixed_rows_mut::<REDUCED>(0)
            .copy_from(&self.reduced.fixed_columns::<UNKNOWNS>(0));
        for (k, value) in self.priors().into_iter().enumerate() {
            jacobian[(REDUCED + k, k)] = value;
        }
        Some(jacobian)
    }
}

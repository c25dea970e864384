//! Least squares of a move: a sum of modes, the frequency of each a function of the pose.
//!
//! ```text
//! delta = sum_m [p_m (q_m - u) + d_m (g_m - q_m) + c_m q_m' + a_m f_m + b_m h_m] + o + K u + s u' + noise
//! ```
//! with `q_m`, `g_m`, and the free decays `f_m`, `h_m`, of [`columns`]. The shares `p`, dampers to ground `d`, lags `c`, `s`, what
//! vibrated before `a`, `b`, offset `o` and gain `K` enter linearly; `ln w` at the nodes of the way, and `xi`, do not.
//! Gauss and Newton's steps, damped as by Levenberg and Marquardt, from Gaussian priors: what the map says.
//!
//! Source: L. Ljung, System Identification, 2nd ed., ch. 7.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::map::Predicted;
use super::path::{NODES, Way};
use super::response::{COLUMNS, columns};
use crate::estimators::Sample;

/// Unknowns of a mode that do not enter linearly: `ln w` at the nodes, and `xi`.
pub const OF_A_MODE: usize = NODES + 1;
/// Linear unknowns that belong to no mode: offset, gain, slope of the input.
const COMMON: usize = 3;
/// Steps at most; a dozen is usual.
const STEPS: usize = 25;
/// Relative difference at which the derivative by an unknown is taken: its square is far below the noise, and its
/// rounding, too.
const DIFFERENCE: f64 = 1e-4;
/// Damping ratios that are looked at.
const DAMPING: (f64, f64) = (1e-4, 0.5);
/// Standard deviations of a static gain and, s, of what a clock's offset makes of the input's slope.
const GAIN_STD: f64 = 0.05;
const LAG_STD: f64 = 2e-3;
/// Standard deviation of a mode's share, of that of a damper to ground, and of `c w`: a lag of 2 ms at 20 Hz makes 0.25 of it.
const SHARE_STD: f64 = 2.0;
const GROUND_STD: f64 = 1.0;
const RATE_STD: f64 = 0.3;
/// A sample further away than so many standard deviations is none of the vibration: noise is once in two million.
const SPIKE: f64 = 5.0;

/// Mode at a move: where it is, or is believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// `ln w` at the nodes.
    pub log_w: [f64; NODES],
    /// Damping ratio.
    pub xi: f64,
}

/// The prior of a mode on the way of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// `ln w` at the nodes.
    pub log_w: Predicted,
    /// Mean and variance of `xi`.
    pub xi: (f64, f64),
}

impl Prior {
    /// Mean of `ln w` at the nodes, and `xi`.
    pub fn mean(&self) -> SVector<f64, OF_A_MODE> {
        SVector::from_fn(|i, _| match i {
            NODES => self.xi.0,
            i => self.log_w.mean[i],
        })
    }

    /// Inverse covariance.
    pub fn precision(&self) -> SMatrix<f64, OF_A_MODE, OF_A_MODE> {
        let mut precision = SMatrix::<f64, OF_A_MODE, OF_A_MODE>::zeros();
        // A trace of a node of its own keeps the matrix regular where all nodes are one place.
        let jitter = SMatrix::from_diagonal_element(1e-8);
        let inverse = (self.log_w.covariance + jitter).try_inverse();
        let inverse = inverse.unwrap_or_else(|| SMatrix::from_diagonal_element(1e8));
        precision
            .fixed_view_mut::<NODES, NODES>(0, 0)
            .copy_from(&inverse);
        precision[(NODES, NODES)] = self.xi.1.recip();
        precision
    }
}

/// A mode as a move has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// Where it is.
    pub point: Point,
    /// Its share `p`.
    pub share: f64,
    /// Standard deviation of the share.
    pub share_std: f64,
    /// Covariance of `ln w` at the nodes and `xi`.
    pub covariance: SMatrix<f64, OF_A_MODE, OF_A_MODE>,
    /// What the samples alone say of them: the precision beside that of the prior.
    pub information: SMatrix<f64, OF_A_MODE, OF_A_MODE>,
    /// The prior that it was fitted with.
    pub prior: Prior,
}

/// The fit of a move.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The modes, in the order of their priors.
    pub modes: Vec<Fitted>,
    /// Sum of squares of the residual.
    pub square: f64,
    /// Samples that count.
    pub samples: f64,
    /// Variance of the residual.
    pub variance: f64,
    /// By how much its colour widens what is known.
    pub inflation: f64,
    /// Residual at each sample; spikes are no numbers.
    pub residual: Vec<f64>,
}

impl Fit {
    /// Part of the residual's variance that its colour tells from white noise: what the modes leave unexplained.
    pub fn unexplained(&self) -> f64 {
        // The correlation of neighbours: white noise has none, what vibrates nearly 1.
        let correlation = (self.inflation - 1.0) / (self.inflation + 1.0);
        correlation * self.variance
    }
}

/// The samples of a move and its way.
#[derive(Clone, Debug)]
pub struct Problem<'a> {
    /// Samples.
    pub samples: &'a [Sample],
    /// From start to end.
    pub way: Way,
    /// Lowest and highest `ln w`.
    pub range: (f64, f64),
    counts: Vec<bool>,
    slopes: Vec<f64>,
    largest: f64,
}

/// The solution of the linear unknowns at some modes.
struct Linear {
    design: DMatrix<f64>,
    unknowns: DVector<f64>,
    residual: DVector<f64>,
    square: f64,
    /// With what the priors say.
    cost: f64,
}

impl<'a> Problem<'a> {
    /// Of finite samples in the order of time.
    pub fn new(samples: &'a [Sample], way: Way, range: (f64, f64)) -> Self {
        let slope = |k: usize| {
            let (a, b) = (
                samples[k.saturating_sub(1)],
                samples[(k + 1).min(samples.len() - 1)],
            );
            (b.motor_position - a.motor_position) / (b.time - a.time).max(f64::MIN_POSITIVE)
        };
        Self {
            counts: vec![true; samples.len()],
            slopes: (0..samples.len()).map(slope).collect(),
            largest: samples.iter().fold(0.0, |m, s| s.deformation.abs().max(m)),
            samples,
            way,
            range,
        }
    }

    /// Samples that count.
    pub fn count(&self) -> f64 {
        self.counts.iter().filter(|counts| **counts).count() as f64
    }

    fn columns(&self, point: &Point) -> [Vec<f64>; COLUMNS] {
        let log_w = |position| {
            self.way
                .value(&point.log_w, position)
                .clamp(self.range.0, self.range.1)
        };
        columns(self.samples, log_w, point.xi).of
    }

    fn design(&self, points: &[Point]) -> DMatrix<f64> {
        let (n, own) = (self.samples.len(), COLUMNS * points.len());
        let mut design = DMatrix::zeros(n, own + COMMON);
        for (m, point) in points.iter().enumerate() {
            for (c, column) in self.columns(point).iter().enumerate() {
                design.set_column(COLUMNS * m + c, &DVector::from_column_slice(column));
            }
        }
        let origin = self.samples[0].motor_position;
        for (k, sample) in self.samples.iter().enumerate() {
            design[(k, own)] = 1.0;
            design[(k, own + 1)] = sample.motor_position - origin;
            design[(k, own + 2)] = self.slopes[k];
        }
        for k in (0..n).filter(|k| !self.counts[*k]) {
            design.row_mut(k).fill(0.0);
        }
        design
    }

    /// Inverse variances of the linear unknowns.
    fn linear_precision(&self, modes: usize) -> DVector<f64> {
        let size = 10.0 * self.largest.max(1e-12);
        let each = [SHARE_STD, GROUND_STD, RATE_STD, size, size];
        let common = [size, GAIN_STD, LAG_STD];
        let stds = (0..modes).flat_map(|_| each).chain(common);
        DVector::from_iterator(COLUMNS * modes + COMMON, stds.map(|std| std.powi(-2)))
    }

    fn measured(&self) -> DVector<f64> {
        let each = self.samples.iter().zip(&self.counts);
        let value = |(s, counts): (&Sample, &bool)| if *counts { s.deformation } else { 0.0 };
        DVector::from_iterator(self.samples.len(), each.map(value))
    }

    fn solve(&self, points: &[Point], priors: &[Prior], variance: f64) -> Option<Linear> {
        let design = self.design(points);
        let measured = self.measured();
        let precision = variance * self.linear_precision(points.len());
        let normal = design.tr_mul(&design) + DMatrix::from_diagonal(&precision);
        let unknowns = normal.cholesky()?.solve(&design.tr_mul(&measured));
        let residual = measured - &design * &unknowns;
        let square = residual.norm_squared();
        let shrunk: f64 = unknowns
            .iter()
            .zip(&precision)
            .map(|(x, p)| p * x * x)
            .sum();
        let away: f64 = points
            .iter()
            .zip(priors)
            .map(|(point, prior)| {
                let d = vector(point) - prior.mean();
                variance * (d.transpose() * prior.precision() * d)[0]
            })
            .sum();
        Some(Linear {
            cost: square + shrunk + away,
            design,
            unknowns,
            residual,
            square,
        })
    }

    /// Derivatives of the model by all unknowns of all modes that do not enter linearly.
    fn slopes_of(&self, points: &[Point], linear: &Linear) -> DMatrix<f64> {
        let mut slopes = DMatrix::zeros(self.samples.len(), OF_A_MODE * points.len());
        for (m, point) in points.iter().enumerate() {
            for n in 0..OF_A_MODE {
                let mut moved = *point;
                match n {
                    NODES => moved.xi += DIFFERENCE,
                    n => moved.log_w[n] += DIFFERENCE,
                }
                let ahead = self.columns(&moved);
                let mut slope = slopes.column_mut(OF_A_MODE * m + n);
                for (c, column) in ahead.iter().enumerate() {
                    let x = linear.unknowns[COLUMNS * m + c] / DIFFERENCE;
                    let here = linear.design.column(COLUMNS * m + c);
                    for (k, value) in slope.iter_mut().enumerate() {
                        if self.counts[k] {
                            *value += x * (column[k] - here[k]);
                        }
                    }
                }
            }
        }
        slopes
    }

    /// The normal equations of all unknowns: matrix and right side.
    fn normal(
        &self,
        points: &[Point],
        priors: &[Prior],
        linear: &Linear,
        variance: f64,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let slopes = self.slopes_of(points, linear);
        let first = linear.design.ncols();
        let n = first + slopes.ncols();
        let mut all = DMatrix::zeros(self.samples.len(), n);
        all.columns_mut(0, first).copy_from(&linear.design);
        all.columns_mut(first, slopes.ncols()).copy_from(&slopes);
        let (mut normal, mut right) = (all.tr_mul(&all), all.tr_mul(&linear.residual));
        let precision = self.linear_precision(points.len());
        for k in 0..first {
            normal[(k, k)] += variance * precision[k];
            right[k] -= variance * precision[k] * linear.unknowns[k];
        }
        for (m, (point, prior)) in points.iter().zip(priors).enumerate() {
            let at = first + OF_A_MODE * m;
            let own = variance * prior.precision();
            let pull = own * (prior.mean() - vector(point));
            let mut block = normal.fixed_view_mut::<OF_A_MODE, OF_A_MODE>(at, at);
            block += own;
            let mut part = right.fixed_rows_mut::<OF_A_MODE>(at);
            part += pull;
        }
        (normal, right)
    }

    fn clamped(&self, point: Point) -> Point {
        Point {
            log_w: point.log_w.map(|w| w.clamp(self.range.0, self.range.1)),
            xi: point.xi.clamp(DAMPING.0, DAMPING.1),
        }
    }

    /// The variance of a residual: rounding at least.
    fn variance(&self, square: f64, unknowns: usize) -> f64 {
        let spare = (self.count() - unknowns as f64).max(1.0);
        (square / spare)
            .max(1e-20 * self.largest * self.largest)
            .max(1e-60)
    }

    /// From a start down to where no step leaves less; spikes are then left out, and it goes on.
    pub fn fit(&mut self, start: &[Point], priors: &[Prior]) -> Option<Fit> {
        let points = self.descend(start, priors)?;
        if self.leave_spikes_out(&points, priors)? {
            let points = self.descend(&points, priors)?;
            return self.conclude(&points, priors);
        }
        self.conclude(&points, priors)
    }

    fn descend(&self, start: &[Point], priors: &[Prior]) -> Option<Vec<Point>> {
        let unknowns = (COLUMNS + OF_A_MODE) * start.len() + COMMON;
        let mut points = start.to_vec();
        // What the priors are weighed against: of a coloured residual fewer samples are independent.
        let mut variance = 1e-4 * self.largest * self.largest;
        let mut now = self.solve(&points, priors, variance)?;
        let mut damping = 1e-2;
        for _ in 0..STEPS {
            let wide = inflation(now.residual.as_slice());
            let next_variance = wide * self.variance(now.square, unknowns);
            if (next_variance / variance - 1.0).abs() > 1e-3 {
                variance = next_variance;
                now = self.solve(&points, priors, variance)?;
            }
            let (normal, right) = self.normal(&points, priors, &now, variance);
            let mut gained = 0.0;
            for _ in 0..6 {
                let Some(tried) = self.stepped(&points, &normal, &right, damping) else {
                    damping *= 10.0;
                    continue;
                };
                let found = self.solve(&tried, priors, variance)?;
                if found.cost < now.cost {
                    gained = now.cost - found.cost;
                    (points, now) = (tried, found);
                    damping = (0.1 * damping).max(1e-9);
                    break;
                }
                damping *= 10.0;
            }
            // What is left to gain is a hundredth of what one standard deviation of an unknown makes.
            if gained < 0.01 * variance {
                break;
            }
        }
        Some(points)
    }

    fn stepped(
        &self,
        points: &[Point],
        normal: &DMatrix<f64>,
        right: &DVector<f64>,
        damping: f64,
    ) -> Option<Vec<Point>> {
        let first = normal.ncols() - OF_A_MODE * points.len();
        let mut damped = normal.clone();
        for k in first..normal.ncols() {
            damped[(k, k)] *= 1.0 + damping;
        }
        let step = damped.cholesky()?.solve(right);
        let each = points.iter().enumerate();
        let moved = each.map(|(m, point)| {
            let at = first + OF_A_MODE * m;
            let own: Vec<f64> = (0..OF_A_MODE).map(|n| step[at + n]).collect();
            // No further than a linearisation carries.
            let most = own.iter().fold(0.1f64, |most, x| most.max(x.abs()));
            let own: Vec<f64> = own.iter().map(|x| x * 0.1 / most).collect();
            self.clamped(Point {
                log_w: core::array::from_fn(|n| point.log_w[n] + own[n]),
                xi: point.xi + own[NODES],
            })
        });
        Some(moved.collect())
    }

    /// Whether there were any that had counted before.
    fn leave_spikes_out(&mut self, points: &[Point], priors: &[Prior]) -> Option<bool> {
        let variance = 1e-6 * self.largest * self.largest;
        let residual = self.solve(points, priors, variance)?.residual;
        let mut sizes: Vec<f64> = residual.iter().map(|r| r.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        // The median of a Gaussian's size is 0.6745 standard deviations.
        let std = sizes[sizes.len() / 2] / 0.6745;
        let mut any = false;
        for (counts, r) in self.counts.iter_mut().zip(residual.iter()) {
            let spike = *counts && r.abs() > SPIKE * std;
            any |= spike;
            *counts &= !spike;
        }
        // Where more than one in twenty lies outside it is the model that is wrong, not the sensor.
        if self.count() < 0.95 * self.samples.len() as f64 {
            self.counts.fill(true);
            any = false;
        }
        Some(any)
    }

    fn conclude(&self, points: &[Point], priors: &[Prior]) -> Option<Fit> {
        let unknowns = (COLUMNS + OF_A_MODE) * points.len() + COMMON;
        let rough = self.solve(points, priors, 1e-6 * self.largest * self.largest)?;
        let variance = self.variance(rough.square, unknowns);
        let inflation = inflation(rough.residual.as_slice());
        let wide = variance * inflation;
        let linear = self.solve(points, priors, wide)?;
        let (normal, _) = self.normal(points, priors, &linear, wide);
        let inverse = normal.cholesky()?.inverse() * wide;
        let first = linear.design.ncols();
        let mut modes = Vec::new();
        for (m, (&point, &prior)) in points.iter().zip(priors).enumerate() {
            let at = first + OF_A_MODE * m;
            let own = inverse
                .fixed_view::<OF_A_MODE, OF_A_MODE>(at, at)
                .into_owned();
            modes.push(Fitted {
                point,
                share: linear.unknowns[COLUMNS * m],
                share_std: inverse[(COLUMNS * m, COLUMNS * m)].sqrt(),
                covariance: own,
                information: not_negative(own.try_inverse()? - prior.precision()),
                prior,
            });
        }
        let mut residual: Vec<f64> = linear.residual.iter().copied().collect();
        for (r, counts) in residual.iter_mut().zip(&self.counts) {
            if !counts {
                *r = f64::NAN;
            }
        }
        Some(Fit {
            modes,
            square: linear.square,
            samples: self.count(),
            variance,
            inflation,
            residual,
        })
    }

    /// The sum of squares that modes leave, linear unknowns at their best.
    pub fn left_by(&self, points: &[Point]) -> Option<f64> {
        let variance = 1e-6 * self.largest * self.largest;
        Some(self.solve(points, &[], variance)?.square)
    }
}

/// A symmetric matrix without what rounding makes negative.
fn not_negative(matrix: SMatrix<f64, OF_A_MODE, OF_A_MODE>) -> SMatrix<f64, OF_A_MODE, OF_A_MODE> {
    let mut eigen = (0.5 * (matrix + matrix.transpose())).symmetric_eigen();
    eigen.eigenvalues.apply(|value| *value = value.max(0.0));
    eigen.recompose()
}

/// `ln w` at the nodes, and `xi`.
pub fn vector(point: &Point) -> SVector<f64, OF_A_MODE> {
    SVector::from_fn(|i, _| match i {
        NODES => point.xi,
        i => point.log_w[i],
    })
}

/// By how much the colour of a residual widens what is known: `(1 + rho) / (1 - rho)`, the variance inflation of a
/// mean of noise of first order; 1 where `rho` is within two standard deviations of 0.
fn inflation(residual: &[f64]) -> f64 {
    let square: f64 = residual.iter().map(|r| r * r).sum();
    let product: f64 = residual.windows(2).map(|pair| pair[0] * pair[1]).sum();
    let rho = product / square.max(f64::MIN_POSITIVE);
    match rho > 2.0 / (residual.len() as f64).sqrt() {
        true => (1.0 + rho.min(0.999)) / (1.0 - rho.min(0.999)),
        false => 1.0,
    }
}

//! The linear unknowns of a fit at given modes, and the normal equations of all.

use nalgebra::{DMatrix, DVector};

use super::Problem;
use crate::estimators::Sample;
use crate::learning::path::NODES;
use crate::learning::point::{OF_A_MODE, Point, Prior};
use crate::learning::response::{COLUMNS, columns};

/// Linear unknowns that belong to no mode: offset, gain, slope of the input.
pub const COMMON: usize = 3;
/// Relative step of the difference quotients: its square and its rounding are both far below the noise.
const DIFFERENCE: f64 = 1e-4;
/// Standard deviations of a static gain and, s, of the slope of the input by a clock's offset.
const GAIN_STD: f64 = 0.05;
const LAG_STD: f64 = 2e-3;
/// Standard deviation of a mode's share, of a damper to ground's share, and of `c w`: a lag of 2 ms at 20 Hz
/// makes 0.25 of the latter.
const SHARE_STD: f64 = 2.0;
const GROUND_STD: f64 = 1.0;
const RATE_STD: f64 = 0.3;

/// The solution of the linear unknowns at some modes.
pub struct Linear {
    pub design: DMatrix<f64>,
    pub unknowns: DVector<f64>,
    pub residual: DVector<f64>,
    pub square: f64,
    /// Cost, priors included.
    pub cost: f64,
}

impl Problem<'_> {
    fn columns(&self, point: &Point) -> [Vec<f64>; COLUMNS] {
        let log_w = |position| {
            self.way
                .value(&point.log_w, position)
                .clamp(self.range.0, self.range.1)
        };
        columns(self.samples, log_w, point.xi, self.cause).of
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

    /// The best linear unknowns.
    pub fn solve(&self, points: &[Point], priors: &[Prior], variance: f64) -> Option<Linear> {
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
                let d = point.vector() - prior.mean();
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

    /// Derivatives of the model by all nonlinear unknowns of all modes.
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
    pub fn normal(
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
            let pull = own * (prior.mean() - point.vector());
            let mut block = normal.fixed_view_mut::<OF_A_MODE, OF_A_MODE>(at, at);
            block += own;
            let mut part = right.fixed_rows_mut::<OF_A_MODE>(at);
            part += pull;
        }
        (normal, right)
    }

    /// The sum of squares with these modes and the best linear unknowns.
    pub fn left_by(&self, points: &[Point]) -> Option<f64> {
        let variance = 1e-6 * self.largest * self.largest;
        Some(self.solve(points, &[], variance)?.square)
    }
}

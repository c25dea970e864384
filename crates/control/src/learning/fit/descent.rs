//! Gauss-Newton steps to the modes of least cost.

use nalgebra::{DMatrix, DVector};

use super::{Fit, Problem, UNKNOWNS};
use crate::learning::fit::linear::COMMON;
use crate::learning::path::NODES;
use crate::learning::point::{OF_A_MODE, Point, Prior};

/// Steps at most; a dozen is usual.
const STEPS: usize = 25;
/// Range of damping ratios.
const DAMPING: (f64, f64) = (1e-4, 0.5);
/// Standard deviations beyond which a sample is a spike: noise exceeds them once in two million samples.
const SPIKE: f64 = 5.0;

impl Problem<'_> {
    fn clamped(&self, point: Point) -> Point {
        Point {
            log_w: point.log_w.map(|w| w.clamp(self.range.0, self.range.1)),
            xi: point.xi.clamp(DAMPING.0, DAMPING.1),
        }
    }

    /// Descends from a start until no step lowers the cost; then removes spikes and continues.
    pub fn fit(&mut self, start: &[Point], priors: &[Prior]) -> Option<Fit> {
        let points = self.descend(start, priors)?;
        if self.leave_spikes_out(&points, priors)? {
            let points = self.descend(&points, priors)?;
            return self.conclude(&points, priors);
        }
        self.conclude(&points, priors)
    }

    fn descend(&self, start: &[Point], priors: &[Prior]) -> Option<Vec<Point>> {
        let unknowns = UNKNOWNS * start.len() + COMMON;
        let mut points = start.to_vec();
        // The weight of the priors falls with the noise at the modes' frequencies.
        let mut variance = 1e-4 * self.largest * self.largest;
        let mut now = self.solve(&points, priors, variance)?;
        let mut damping = 1e-2;
        for _ in 0..STEPS {
            let wide = self.density(&points, &now.residual);
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
            // The remaining gain is a hundredth of that of one standard deviation of an unknown.
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
            // No farther than the linearisation is valid.
            let most = own.iter().fold(0.1f64, |most, x| most.max(x.abs()));
            let own: Vec<f64> = own.iter().map(|x| x * 0.1 / most).collect();
            self.clamped(Point {
                log_w: core::array::from_fn(|n| point.log_w[n] + own[n]),
                xi: point.xi + own[NODES],
            })
        });
        Some(moved.collect())
    }

    /// Marks spikes; returns whether there were new ones.
    fn leave_spikes_out(&mut self, points: &[Point], priors: &[Prior]) -> Option<bool> {
        let variance = 1e-6 * self.largest * self.largest;
        let residual = self.solve(points, priors, variance)?.residual;
        let mut sizes: Vec<f64> = residual.iter().map(|r| r.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        // The median of a Gaussian's absolute value is 0.6745 standard deviations.
        let std = sizes[sizes.len() / 2] / 0.6745;
        let mut any = false;
        for (counts, r) in self.counts.iter_mut().zip(residual.iter()) {
            let spike = *counts && r.abs() > SPIKE * std;
            any |= spike;
            *counts &= !spike;
        }
        // If more than one in twenty lies outside, the model is wrong, not the sensor.
        if self.count() < 0.95 * self.samples.len() as f64 {
            self.counts.fill(true);
            any = false;
        }
        Some(any)
    }
}

//! Whether what a refitted model leaves is nothing.

use super::criteria::Search;
use super::explanation::Explanation;
use super::locate::Located;
use super::normal::{covariance, scales};
use super::thresholds::FLOOR;
use nalgebra::Cholesky;
use quell_signal::noise_floor;

/// Residual, in times the noise, that is a mismatch even if it cannot be located: no estimate of a noise
/// level is that far off.
const CERTAIN: f64 = 1.5;

impl Search<'_> {
    /// Whether nothing but noise is left, on what was fitted and on what was held out.
    pub(super) fn is_quiet(&self, explanation: &Explanation, located: &Located) -> bool {
        let held = self.is_held_noise(explanation);
        // A little above the floor may be noise of another colour, unless it has a place in the chain.
        let little = self.below(explanation, CERTAIN) && located.location.place.is_none();
        self.at_floor(explanation) && held || little
    }

    /// Whether what was held out is nothing but noise and what the errors of the fit make there.
    pub(super) fn is_held_noise(&self, explanation: &Explanation) -> bool {
        self.held_at_floor(explanation) || self.is_foreseen(explanation)
    }

    /// Whether what was held out is missed by no more than noise, rounding at rest, and the errors of what was
    /// fitted make: a force that drives an axis freely carries these on without bound.
    fn is_foreseen(&self, explanation: &Explanation) -> bool {
        if !self.judge.data.apart.is_empty() {
            return false;
        }
        let rows = self.judge.held_out_rows as f64;
        let leverage = self.leverage(explanation).unwrap_or(0.0);
        explanation.held_out <= FLOOR * FLOOR * (rows + leverage) + self.rounding()
    }

    /// Chi-squared that the errors of the fit make on what was held out, `tr(J_h (J' J)^-1 J_h')`.
    ///
    /// Source: Ljung, System Identification (1999), section 16.4.
    fn leverage(&self, explanation: &Explanation) -> Option<f64> {
        let (problem, point) = (self.problem, &explanation.fitted.point);
        let linear = problem.linearise(point, self.projector);
        let normal = problem.normal(point, &linear);
        let scale = scales(&normal);
        let root = Cholesky::new(covariance(&normal, &scale)?)?.l();
        let here = self.judge.held_out_rows_of(problem, point);
        let along = |column: usize| {
            let step = root.column(column).component_div(&scale);
            let moved = problem.stepped(point, &linear.globals, &step);
            let there = self.judge.held_out_rows_of(problem, &moved);
            here.iter()
                .zip(&there)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
        };
        let sum: f64 = (0..root.ncols()).map(along).sum();
        sum.is_finite().then_some(sum)
    }

    /// Chi-squared by which chance may raise what was held out where sensors round: twice the standard
    /// deviation. While a sensor rests its error is one and the same, evenly drawn from a step, and its square
    /// over the mean has a deviation of `sqrt(4 / 5)`.
    fn rounding(&self) -> f64 {
        let data = self.judge.data;
        let mut squares = 0.0;
        for (experiment, held_out) in data.experiments.iter().zip(&data.held_out) {
            for (output, ranges) in experiment.outputs.iter().zip(held_out) {
                let Some(step) = noise_floor(&output.values).quantisation else {
                    continue;
                };
                for range in ranges {
                    squares += rests(&output.values[range.clone()], step);
                }
            }
        }
        2.0 * (0.8 * squares).sqrt()
    }
}

/// Sum of the squared lengths of the stretches in which values stay within a step, and half of one for what
/// rounding differences are off.
fn rests(values: &[f64], step: f64) -> f64 {
    let (mut sum, mut start) = (0.0, 0);
    for k in 1..=values.len() {
        let rests = k < values.len() && (values[k] - values[start]).abs() < 1.5 * step;
        if !rests {
            sum += ((k - start) as f64).powi(2);
            start = k;
        }
    }
    sum
}

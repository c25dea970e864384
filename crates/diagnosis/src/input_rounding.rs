//! Rounding of the recorded input at rest, as a part of the noise.
//!
//! While an encoder rests, its error is constant, uniformly distributed over a step `q`. The simulation carries
//! it into every sample of that rest and into the ringing at both ends of it. Let the columns of `B` be the
//! responses of the whitened rows to errors of one standard deviation, `q / sqrt 12`, one column for each rest,
//! and `B = U D V'`. The covariance of the rows is then `I + B B'`, and
//!
//! ```text
//! (I + B B')^-1/2 = I - U (1 - (1 + D^2)^-1/2) U'
//! ```
//!
//! whitens them. In motion the rounding is noise (`input_noise.rs`).
//!
//! Source: Widrow and Kollar, Quantization Noise (2008), chapter 4, for the error; Aitken, Proc. Royal Society of
//! Edinburgh 55 (1935), for least squares with a covariance.

use super::input_error::levels;
use super::point::Point;
use super::problem::{Problem, Responses, Rows};
use nalgebra::{DMatrix, DVector};
use quell_model::{Experiment, InputError};
use std::ops::Range;

/// Variance of a direction, relative to the noise, below which it is ignored: chi-squared is then too large by
/// as much.
const NONE: f64 = 1e-3;

impl Problem<'_> {
    /// Responses of every experiment to the rounding of its input, about a point.
    pub fn responses_to_rounding(&self, point: &Point) -> Vec<Responses> {
        let all = self.experiments.iter().enumerate();
        all.map(|(e, experiment)| self.responses_of(point, e, experiment))
            .collect()
    }

    fn responses_of(&self, point: &Point, e: usize, experiment: &Experiment) -> Responses {
        let InputError::Rounding(step) = InputError::of(experiment) else {
            return Vec::new();
        };
        // A constant error of a force moves the following motion without bound. Windows handle that case.
        if self.scales.forced || !experiment.windows.is_empty() {
            return Vec::new();
        }
        let (time, values) = (&experiment.input_time, &experiment.input_values);
        // The mode does not respond within less than a period.
        let rests = levels(values, step).into_iter();
        let rests = rests.filter(|own| time[own.end - 1] - time[own.start] >= self.scales.period());
        let here = self.run(point, e).residuals;
        let response = |rest: Range<usize>| {
            let mut other = values.clone();
            for value in &mut other[rest] {
                *value += step / 12f64.sqrt();
            }
            self.response_to_input((point, &here), e, other)
        };
        rests.map(response).collect()
    }
}

/// The part of the covariance of an experiment's rows that comes from the rounding of its input.
pub struct RoundingCovariance {
    /// `U`.
    directions: DMatrix<f64>,
    /// `1 - (1 + D^2)^-1/2`.
    shrinks: DVector<f64>,
}

impl RoundingCovariance {
    /// The covariance for these rows of an experiment.
    pub fn new(problem: &Problem, e: usize, rows: &[Rows]) -> Self {
        let responses = problem.input_rounding.get(e).into_iter().flatten();
        let column =
            |series: &Vec<Vec<f64>>| DVector::from_vec(problem.weigh_rows(e, series, rows));
        let columns: Vec<DVector<f64>> = responses.map(column).collect();
        match columns.is_empty() {
            true => Self {
                directions: DMatrix::zeros(0, 0),
                shrinks: DVector::zeros(0),
            },
            false => Self::of(&DMatrix::from_columns(&columns)),
        }
    }

    /// The part `B B'` beside unit variance.
    fn of(b: &DMatrix<f64>) -> Self {
        let eigen = b.tr_mul(b).symmetric_eigen();
        let squares = &eigen.eigenvalues;
        let seen: Vec<usize> = (0..b.ncols()).filter(|&k| squares[k] > NONE).collect();
        let mut directions = b * eigen.eigenvectors.select_columns(&seen);
        for (mut direction, &k) in directions.column_iter_mut().zip(&seen) {
            direction.unscale_mut(squares[k].sqrt());
        }
        let shrinks = seen
            .iter()
            .map(|&k| 1.0 - (1.0 + squares[k]).sqrt().recip());
        Self {
            shrinks: DVector::from_iterator(seen.len(), shrinks),
            directions,
        }
    }

    /// Whitens rows whose covariance is unit variance plus the rounding. Rows behind them (the witness') stay
    /// as they are.
    pub fn whiten(&self, rows: &mut [f64]) {
        let (count, directions) = self.directions.shape();
        if directions == 0 {
            return;
        }
        let mut rows = nalgebra::DVectorViewMut::from_slice(&mut rows[..count], count);
        let shares = self.directions.tr_mul(&rows).component_mul(&self.shrinks);
        rows.gemv(-1.0, &self.directions, &shares, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Twice whitened and multiplied by `I + B B'`, rows are what they were; those behind them always are.
        #[test]
        fn whitens_twice_to_the_inverse(
            values in proptest::collection::vec(-3.0..3.0f64, 60),
            rows in proptest::collection::vec(-1e3..1e3f64, 22),
        ) {
            let b = DMatrix::from_column_slice(20, 3, &values);
            let covariance = RoundingCovariance::of(&b);
            let mut white = rows.clone();
            covariance.whiten(&mut white);
            covariance.whiten(&mut white);
            prop_assert_eq!(&white[20..], &rows[20..]);
            let white = DVector::from_column_slice(&white[..20]);
            let back = &white + &b * b.tr_mul(&white);
            let first = DVector::from_column_slice(&rows[..20]);
            // Directions of less than `NONE` are left out.
            prop_assert!((back - &first).norm() <= 2.0 * NONE * first.norm());
        }
    }
}

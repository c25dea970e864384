//! Rounding of the recorded input while it rests, as a part of the noise.
//!
//! While an encoder rests its error is one and the same, evenly drawn from a step `q`, and the simulation carries it into
//! every sample of that rest and into the ringing at both ends of it. Let the columns of `B` be the whitened rows'
//! responses to errors of one deviation, `q / sqrt 12`, a rest each, and `B = U D V'`. The covariance of the rows is then
//! `I + B B'`, and
//!
//! ```text
//! (I + B B')^-1/2 = I - U (1 - (1 + D^2)^-1/2) U'
//! ```
//!
//! makes them white. What moves averages its rounding out.
//!
//! Source: Widrow and Kollar, Quantization Noise (2008), chapter 4, for the error; Aitken, Proc. Royal Society of
//! Edinburgh 55 (1935), for least squares with a covariance.

use super::input_error::{InputError, levels};
use super::point::Point;
use super::problem::{Problem, Responses, Rows};
use nalgebra::{DMatrix, DVector};
use quell_model::Experiment;
use std::ops::Range;

/// Variance of a direction, in that of the noise, below which it is left out: chi-squared is then too large by as much.
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
        // A force that is wrong for a while moves what follows without bound: windows are for that.
        if self.scales.forced || !experiment.windows.is_empty() {
            return Vec::new();
        }
        let (time, values) = (&experiment.input_time, &experiment.input_values);
        // In less than a period the mode does not follow.
        let rests = levels(values, step).into_iter();
        let rests = rests.filter(|own| time[own.end - 1] - time[own.start] >= self.scales.period());
        let here = self.run(point, e).residuals;
        let mut experiments = self.experiments.to_vec();
        let response = |rest: Range<usize>| {
            let mut other = values.clone();
            for value in &mut other[rest] {
                *value += step / 12f64.sqrt();
            }
            experiments[e] = experiment.with_input(other);
            let moved = Problem {
                experiments: &experiments,
                ..self.clone()
            };
            let there = moved.run(point, e).residuals;
            let less =
                |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| a - b).collect();
            here.iter().zip(&there).map(less).collect()
        };
        rests.map(response).collect()
    }
}

/// The part of the covariance of an experiment's rows that the rounding of its input makes.
pub struct RoundingCovariance {
    /// `U`.
    directions: DMatrix<f64>,
    /// `1 - (1 + D^2)^-1/2`.
    shrinks: DVector<f64>,
}

impl RoundingCovariance {
    /// Of these rows of an experiment.
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

    /// Beside unit variance: `B B'`.
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

    /// Makes rows white that were of unit variance but for the rounding; those behind them stay.
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

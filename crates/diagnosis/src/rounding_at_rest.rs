//! Rounding of the recorded input and of the sensors at rest, as a part of the noise.
//!
//! While a sensor rests, the mean error of its samples is one number ([`Rounding`]). A sensor of the output adds it to the
//! samples of that rest. An encoder that is the input has no noise; the simulation carries its error into every sample of the
//! rest and into the ringing at both ends of it. Let the columns of `B` be the responses of the whitened rows to errors of
//! one standard deviation, one column for each rest, and `B = U D V'`. The covariance of the rows is then `I + B B'`, and
//!
//! ```text
//! (I + B B')^-1/2 = I - U (1 - (1 + D^2)^-1/2) U'
//! ```
//!
//! whitens them. In motion the rounding is noise (`input_noise.rs`).
//!
//! Source: Aitken, Proc. Royal Society of Edinburgh 55 (1935), for least squares with a covariance.

use super::input_error::levels;
use super::noise::{LOUDER, step};
use super::point::Point;
use super::problem::{Problem, Responses, Rows};
use super::spread::spread;
use nalgebra::{DMatrix, DVector};
use quell_model::InputError;
use quell_signal::Rounding;
use std::ops::Range;
use std::sync::Arc;

/// Variance of a direction, relative to the noise, below which it is ignored: chi-squared is then too large by
/// as much.
const NONE: f64 = 1e-3;
/// Most rests of a sensor, the longest ones: as many columns as a derivative by all unknowns has. Shorter ones of so many are
/// stretches of a slow motion.
const MOST: usize = 64;

impl Problem<'_> {
    /// Sets the responses from a better model, if a column differs from the present one by more than chance: beside the error
    /// of a model rounding hardly counted. Returns whether one does.
    pub fn round_again(&mut self, point: &Point) -> bool {
        let found = self.responses_to_rounding(point);
        let sizes = |of: &[Responses]| -> Vec<f64> {
            let columns = of.iter().flatten();
            let squares =
                |column: &Vec<Vec<f64>>| column.iter().flatten().map(|value| value * value).sum();
            columns.map(squares).collect()
        };
        let (old, new) = (sizes(&self.rounding_at_rest), sizes(&found));
        let ratio = |(old, new): (&f64, &f64)| (old / new).max(new / old);
        let differs = old.len() != new.len()
            || old
                .iter()
                .zip(&new)
                .map(ratio)
                .any(|ratio| ratio > LOUDER * LOUDER);
        if differs {
            self.rounding_at_rest = Arc::new(found);
        }
        differs
    }

    /// Responses of every experiment to its rounding at rest, about a point.
    pub fn responses_to_rounding(&self, point: &Point) -> Vec<Responses> {
        let all = 0..self.experiments.len();
        all.map(|e| {
            let here = self.run(point, e).residuals;
            let mut responses = self.responses_to_input((point, &here), e);
            responses.extend(self.errors_of_outputs(here, e));
            responses
        })
        .collect()
    }

    /// Responses to the rounding of the input in each of its rests, about a point with the residuals `here`.
    fn responses_to_input(&self, (point, here): (&Point, &[Vec<f64>]), e: usize) -> Responses {
        let experiment = &self.experiments[e];
        let InputError::Rounding(step) = InputError::of(experiment) else {
            return Vec::new();
        };
        // A constant error of a force moves the following motion without bound. Windows handle that case.
        if self.scales.forced || !experiment.windows.is_empty() {
            return Vec::new();
        }
        let (time, values) = (&experiment.input_time, &experiment.input_values);
        let rests = self.longest(time, levels(values, step)).into_iter();
        let response = |rest: Range<usize>| {
            self.response_to((point, here), e, |sign| {
                let mut other = values.clone();
                for value in &mut other[rest.clone()] {
                    *value += sign * step / 12f64.sqrt();
                }
                experiment.with_input(other)
            })
        };
        rests.map(response).collect()
    }

    /// Errors of every output in each of its rests; none where its noise averages the rounding out.
    ///
    /// They are told in units of the residual where that is above the noise: what is left is then the model's error, beside
    /// which the rounding of a rest is as small as that of a sample.
    fn errors_of_outputs(&self, here: Vec<Vec<f64>>, e: usize) -> Responses {
        let outputs = &self.experiments[e].outputs;
        let left = self.without_nuisances(e, here);
        let zeros: Vec<Vec<f64>> = outputs.iter().map(|o| vec![0.0; o.values.len()]).collect();
        let mut errors = Vec::new();
        for (index, output) in outputs.iter().enumerate() {
            let level = self.sensor_noise[e][index].deviation;
            let sensor = step(output).and_then(|step| Rounding::of(step, level));
            let Some(sensor) = sensor else {
                continue;
            };
            let above = (spread(&left[index]) / level).max(1.0);
            let error = sensor.mean_error() / above;
            if error * error * output.values.len() as f64 <= NONE * level * level {
                continue;
            }
            for rest in self.longest(&output.time, sensor.rests(&output.values)) {
                let mut series = zeros.clone();
                series[index][rest].fill(error);
                errors.push(series);
            }
        }
        errors
    }

    /// The longest stretches. The mode does not respond within less than a period.
    fn longest(&self, time: &[f64], mut stretches: Vec<Range<usize>>) -> Vec<Range<usize>> {
        stretches.retain(|own| time[own.end - 1] - time[own.start] >= self.scales.period());
        stretches.sort_by_key(|own| std::cmp::Reverse(own.len()));
        stretches.truncate(MOST);
        stretches
    }
}

/// The part of the covariance of an experiment's rows that comes from rounding at rest.
pub struct RoundingCovariance {
    /// `U`.
    directions: DMatrix<f64>,
    /// `1 - (1 + D^2)^-1/2`.
    shrinks: DVector<f64>,
}

impl RoundingCovariance {
    /// The covariance for these rows of an experiment.
    pub fn new(problem: &Problem, e: usize, rows: &[Rows]) -> Self {
        let responses = problem.rounding_at_rest.get(e).into_iter().flatten();
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

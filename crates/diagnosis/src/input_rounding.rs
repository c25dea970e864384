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

/// Variance of a direction, in that of the noise, below which it is none.
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
        let response = |rest: std::ops::Range<usize>| {
            let mut other = values.clone();
            for value in &mut other[rest] {
                *value += step / 12f64.sqrt();
            }
            let mut experiments = self.experiments.to_vec();
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
        let responses = problem.rounding.get(e).into_iter().flatten();
        let column =
            |series: &Vec<Vec<f64>>| DVector::from_vec(problem.weigh_rows(e, series, rows));
        let columns: Vec<DVector<f64>> = responses.map(column).collect();
        if columns.is_empty() {
            return Self {
                directions: DMatrix::zeros(0, 0),
                shrinks: DVector::zeros(0),
            };
        }
        let all = DMatrix::from_columns(&columns);
        let eigen = all.tr_mul(&all).symmetric_eigen();
        let seen: Vec<usize> = (0..columns.len())
            .filter(|&k| eigen.eigenvalues[k] > NONE)
            .collect();
        let direction =
            |&k: &usize| &all * eigen.eigenvectors.column(k) / eigen.eigenvalues[k].sqrt();
        let directions: Vec<DVector<f64>> = seen.iter().map(direction).collect();
        let shrink = |&k: &usize| 1.0 - (1.0 + eigen.eigenvalues[k]).sqrt().recip();
        Self {
            shrinks: DVector::from_iterator(seen.len(), seen.iter().map(shrink)),
            directions: match directions.is_empty() {
                true => DMatrix::zeros(0, 0),
                false => DMatrix::from_columns(&directions),
            },
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

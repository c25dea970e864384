//! The error of a sensor that rounds, which is constant at rest.
//!
//! Source: Widrow and Kollar, Quantization Noise (2008), chapter 4.

use super::problem::Rows;
use quell_model::Experiment;
use quell_signal::{Rounding, noise_floor};

/// Chi-squared that chance may add to held-out rows of sensors that round: twice its standard deviation. At
/// rest the error is constant, uniformly distributed over a step. Its square, relative to the mean, has a
/// standard deviation of `sqrt(4 / 5)`.
pub fn rounding(experiments: &[Experiment], rows: &[Vec<Rows>]) -> f64 {
    let mut squares = 0.0;
    for (experiment, rows) in experiments.iter().zip(rows) {
        for (output, ranges) in experiment.outputs.iter().zip(rows) {
            let step = noise_floor(&output.values).quantisation;
            let Some(sensor) = step.and_then(|step| Rounding::of(step, 0.0)) else {
                continue;
            };
            for range in ranges {
                let rests = sensor.rests(&output.values[range.clone()]).into_iter();
                squares += rests.map(|rest| (rest.len() as f64).powi(2)).sum::<f64>();
            }
        }
    }
    2.0 * (0.8 * squares).sqrt()
}

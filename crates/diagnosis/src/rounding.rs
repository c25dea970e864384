//! The error of a sensor that rounds, which is constant at rest.
//!
//! Source: Widrow and Kollar, Quantization Noise (2008), chapter 4.

use super::problem::Rows;
use quell_model::Experiment;
use quell_signal::noise_floor;

/// Chi-squared that chance may add to held-out rows of sensors that round: twice its standard deviation. At
/// rest the error is constant, uniformly distributed over a step. Its square, relative to the mean, has a
/// standard deviation of `sqrt(4 / 5)`.
pub fn rounding(experiments: &[Experiment], rows: &[Vec<Rows>]) -> f64 {
    let mut squares = 0.0;
    for (experiment, rows) in experiments.iter().zip(rows) {
        for (output, ranges) in experiment.outputs.iter().zip(rows) {
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

/// Sum of the squared lengths of the stretches in which values stay within one and a half steps: half a step allows
/// for rounding of the differences.
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

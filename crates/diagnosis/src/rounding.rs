//! The error of a sensor that rounds, which is one and the same while it rests.
//!
//! Source: Widrow and Kollar, Quantization Noise (2008), chapter 4.

use super::problem::Rows;
use quell_model::Experiment;
use quell_signal::noise_floor;

/// Chi-squared by which chance may raise what was held out where sensors round: twice the standard deviation. While a
/// sensor rests its error is one and the same, evenly drawn from a step, and its square over the mean has a deviation
/// of `sqrt(4 / 5)`.
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

//! Noise of a replicate's outputs: drawn from its model, or from blocks of the residual.
//!
//! If an explanation leaves more than noise, its residual is neither white nor of the noise's colour. Then
//! blocks of it, a few periods of the mode long, are put together at random, so that the correlation within a
//! block is kept. Source: Kuensch, Annals of Statistics 17 (1989).

use crate::explanation::Explanation;
use crate::search::Search;
use crate::whitening::Whitening;
use quell_model::{InputError, Output};
use quell_recording::health::quantum;
use rand::Rng;
use rand_distr::StandardNormal;
use std::ops::Range;

/// Length of a block, in periods of the mode: after three periods a joint with a damping ratio of 0.1 has lost
/// 85 % of its amplitude.
const BLOCK_PERIODS: f64 = 3.0;
/// Fewest blocks in the fitted rows; with fewer they are all alike.
const FEWEST_BLOCKS: usize = 10;
/// Standard deviations of a mean of squares that are beyond chance.
const CHANCE: f64 = 3.0;

/// Source of the noise of one output.
pub enum OutputNoise {
    /// Its own model.
    Model(Whitening),
    /// A sensor that rounds white noise. In small motion its error is not random, and its levels stay where
    /// they were.
    Rounding {
        /// Standard deviation before it is rounded.
        white: f64,
        /// Its step.
        step: f64,
        /// One of its levels.
        level: f64,
    },
    /// The residual in blocks.
    Blocks {
        /// Recorded minus predicted.
        residual: Vec<f64>,
        /// Fitted samples.
        fitted: Vec<Range<usize>>,
        /// Samples of a block.
        length: usize,
    },
}

/// The noise of every output of an experiment; `left` is recorded minus predicted.
pub fn of(search: &Search, best: &Explanation, e: usize, left: &[Vec<f64>]) -> Vec<OutputNoise> {
    let problem = search.problem;
    let outputs = &problem.experiments[e].outputs;
    let unit = search.judge.unit(best);
    let chance = CHANCE * (2.0 / search.judge.train_rows.max(1) as f64).sqrt();
    let input = InputError::of(&problem.experiments[e]);
    let noise = |(k, output): (usize, &Output)| {
        let noise = match input {
            // That of the input is drawn with the input: it is there in motion only.
            InputError::Rounding(_) => {
                let raised = problem.whitening[e][k].deviation / problem.noise[e][k].deviation;
                problem.sensor_noise[e][k].louder(raised)
            }
            _ => problem.whitening[e][k].clone(),
        };
        let whitening = noise.louder(unit.sqrt());
        if let Some(rounding) = rounding(output, &whitening) {
            return rounding;
        }
        let fitted = problem.rows[e][k].clone();
        let count: usize = fitted.iter().map(|range| range.len()).sum();
        if unit > 1.0 + chance && count > 0 {
            let n = output.time.len();
            let spacing = (output.time[n - 1] - output.time[0]) / n as f64;
            let length = (BLOCK_PERIODS * problem.scales.period() / spacing) as usize;
            return OutputNoise::Blocks {
                residual: left[k].clone(),
                length: length.min(count / FEWEST_BLOCKS).max(1),
                fitted,
            };
        }
        OutputNoise::Model(whitening)
    };
    outputs.iter().enumerate().map(noise).collect()
}

/// A sensor whose noise is mostly rounding.
fn rounding(output: &Output, noise: &Whitening) -> Option<OutputNoise> {
    let step = quantum(&output.values)?;
    let (power, own) = (noise.deviation.powi(2), step * step / 12.0);
    (own > 0.5 * power).then(|| OutputNoise::Rounding {
        white: (power - own).max(0.0).sqrt(),
        step,
        level: output.values[0],
    })
}

impl OutputNoise {
    /// Reading of a sensor for a prediction. `blocks` draws the blocks.
    pub fn on(
        &self,
        predicted: &[f64],
        random: &mut impl Rng,
        blocks: &(impl Rng + Clone),
    ) -> Vec<f64> {
        let noise = match self {
            &Self::Rounding { white, step, level } => {
                let rounded = |y: &f64| {
                    let seen = y + white * random.sample::<f64, _>(StandardNormal);
                    level + step * ((seen - level) / step).round()
                };
                return predicted.iter().map(rounded).collect();
            }
            Self::Model(whitening) => whitening.draw(predicted.len(), random),
            Self::Blocks {
                residual,
                fitted,
                length,
            } => in_blocks(residual, fitted, *length, &mut blocks.clone()),
        };
        predicted.iter().zip(noise).map(|(y, e)| y + e).collect()
    }
}

/// As many values as the residual has, in blocks of the fitted samples.
fn in_blocks(
    residual: &[f64],
    fitted: &[Range<usize>],
    length: usize,
    random: &mut impl Rng,
) -> Vec<f64> {
    let count: usize = fitted.iter().map(|range| range.len()).sum();
    let mut values = Vec::with_capacity(residual.len() + length);
    while values.len() < residual.len() {
        // Each sample is equally likely to be the middle of a block.
        let mut pick = (random.random::<f64>() * count as f64) as usize;
        for range in fitted {
            if pick < range.len() {
                let end = (range.start + pick + length / 2 + 1).min(range.end);
                let start = end.saturating_sub(length).max(range.start);
                values.extend_from_slice(&residual[start..end]);
                break;
            }
            pick -= range.len();
        }
    }
    values.truncate(residual.len());
    values
}

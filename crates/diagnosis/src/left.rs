//! Whether what an explanation leaves is noise.

use super::explanation::{Explanation, Judge};
use super::found::Found;
use super::locate::Located;
use super::problem::Rows;
use super::search::Search;
use super::thresholds::FLOOR;
use quell_model::Experiment;
use quell_signal::noise_floor;

/// Residual, in times the noise, that is a mismatch even if it cannot be located: no estimate of a noise
/// level is that far off.
const CERTAIN: f64 = 1.5;

impl Judge<'_> {
    /// Whether what an explanation leaves, beyond what the shapes of its laws could be wrong by, is noise: of what was
    /// fitted, and of what was held out beyond the errors of the fit and rounding at rest.
    pub fn leaves_noise(&self, own: &Explanation) -> bool {
        let (fitted, held) = (self.train_rows as f64, self.held_out_rows as f64);
        let beyond = own.evidence.held_out_beyond_fit();
        let [_, held_out] = self.rounded;
        let chance = 2.0 * (VARIANCE * held_out).sqrt();
        own.evidence.left() <= FLOOR * fitted && beyond <= FLOOR * held + chance
    }

    /// Samples of what an explanation leaves that say as much as one independent one.
    pub fn correlation(&self, own: &Explanation) -> f64 {
        let samples: usize = self.data.experiments.iter().map(|e| e.samples()).sum();
        let of_rounding = 1.0 + VARIANCE * self.rounded[0] / (2 * samples.max(1)) as f64;
        own.evidence.correlation().max(of_rounding)
    }
}

impl Search<'_> {
    /// Whether what an explanation leaves is noise.
    pub fn leaves_noise(&self, own: &Explanation) -> bool {
        self.judge.leaves_noise(own)
    }

    /// Whether the refitted model leaves nothing that could be located: a little above the noise may be noise of
    /// another colour, unless it has a place in the chain.
    pub fn leaves_nothing(&self, found: &Found, located: &Located) -> bool {
        let own = &found.baseline;
        let below = |chi: f64, rows: usize| chi <= CERTAIN * CERTAIN * rows as f64;
        let little = below(own.train, self.judge.train_rows)
            && below(own.held_out, self.judge.held_out_rows);
        self.leaves_noise(own) || little && located.location.place.is_none()
    }

    /// Whether the best explanation leaves nothing but noise.
    pub fn explains(&self, found: &Found) -> bool {
        self.leaves_noise(&found.best)
    }
}

/// Sum of the squared lengths of the stretches of rows in which sensors that round are at rest.
///
/// While a sensor rests its error is one and the same, evenly drawn from a step, and its square over the mean has a
/// deviation of `sqrt(4 / 5)`: chi-squared has four fifths of this sum for a variance, beside two for each row.
pub fn rounded(experiments: &[Experiment], rows: &[Vec<Rows>]) -> f64 {
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
    squares
}

/// Variance of the mean square of such an error, in that of a step's.
pub const VARIANCE: f64 = 0.8;

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

//! Rests of a tracker whose coordinates are rounded: their samples share an error.

use quell_signal::Rounding;
use std::ops::Range;

/// Rests of a sensor that rounds, in which all samples have one error `s` more. Samples of variance `v` of which `s^2` is
/// common have the variance `v + (n - 1) s^2` along the mean of `n` of them, and `v - s^2` across it.
pub struct Rests {
    stretches: Vec<Range<usize>>,
    /// `s^2 / v`.
    common: f64,
}

impl Rests {
    /// From the angle, which shows where the tip rests, with the coordinates' step and the level of the radius' noise, both in
    /// lever arms.
    pub fn new(angle: &[f64], step: f64, level: f64) -> Self {
        // A circle through few rests leaves less than their errors.
        let level = level.max(step / 12f64.sqrt());
        let Some(sensor) = Rounding::of(step, level) else {
            return Self {
                stretches: Vec::new(),
                common: 0.0,
            };
        };
        Self {
            stretches: sensor.rests(angle),
            common: (sensor.mean_error() / level).powi(2),
        }
    }

    /// Samples as which each one counts: the squares of `n` whitened ones of a rest have the mean `n v - (n - 1) s^2`.
    pub fn worth(&self, mut worth: Vec<f64>) -> Vec<f64> {
        for rest in &self.stretches {
            let lost = self.common * (1.0 - (rest.len() as f64).recip());
            worth[rest.clone()].iter_mut().for_each(|own| *own -= lost);
        }
        worth
    }

    /// Rows whose errors are independent of each other.
    pub fn whitened<const N: usize>(&self, mut rows: Vec<[f64; N]>) -> Vec<[f64; N]> {
        for rest in &self.stretches {
            let own = &mut rows[rest.clone()];
            let shrink = 1.0 - (1.0 + (own.len() - 1) as f64 * self.common).sqrt().recip();
            for column in 0..N {
                let sum: f64 = own.iter().map(|row| row[column]).sum();
                let common = shrink * sum / own.len() as f64;
                own.iter_mut().for_each(|row| row[column] -= common);
            }
        }
        rows
    }
}

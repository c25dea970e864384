//! The spectral density of a residual at the frequencies of the modes.
//!
//! The parameters of a sinusoid in coloured noise have the variance that they have in white noise of the density at its
//! frequency, whatever the noise is elsewhere:
//! ```text
//! V = V_white S(w) / S_white,    S(w) = |sum_k r_k exp(-i w t_k)|^2 / N
//! ```
//! Correlation of neighbours does not tell it: white noise on top hides slow motion from it, and slow drift pretends a
//! density that is not at the mode.
//!
//! Source: P. Stoica, R. Moses, Spectral Analysis of Signals, 2005, ch. 4.

use core::f64::consts::TAU;
use nalgebra::DVector;

use super::{Problem, UNKNOWNS};
use crate::learning::path::NODES;
use crate::learning::point::Point;

/// Frequencies `2 pi / T` apart on each side of a mode's own: with its own as many as the mode has unknowns, and one. Each has
/// two degrees of freedom, so that the mode takes half of them.
const SIDE: i32 = (UNKNOWNS / 2) as i32;

impl Problem<'_> {
    /// Density of a residual over that of white noise of its variance, the largest of all modes; at least 1.
    pub(super) fn density(&self, points: &[Point], residual: &DVector<f64>) -> f64 {
        let at = |point: &Point| self.density_at(point.log_w[NODES - 1].exp(), residual);
        points.iter().map(at).fold(1.0, f64::max)
    }

    /// The same around one frequency, rad/s, without what the unknowns of the mode have taken.
    fn density_at(&self, own: f64, residual: &DVector<f64>) -> f64 {
        let [first, .., last] = self.samples else {
            return 1.0;
        };
        let bin = TAU / (last.time - first.time).max(f64::MIN_POSITIVE);
        let around = (-SIDE..=SIDE).map(|side| own + f64::from(side) * bin);
        // Offset and gain have taken what is slower than the motion.
        let around: Vec<f64> = around.filter(|w| *w > bin).collect();
        let sum: f64 = around.iter().map(|w| self.power(*w, residual)).sum();
        let spare = around.len() as f64 - 0.5 * UNKNOWNS as f64;
        sum / spare.max(1.0) / residual.norm_squared().max(f64::MIN_POSITIVE)
    }

    /// `|sum_k r_k exp(-i w t_k)|^2`.
    fn power(&self, w: f64, residual: &DVector<f64>) -> f64 {
        let each = self.samples.iter().zip(residual.iter());
        let (re, im) = each.fold((0.0, 0.0), |(re, im), (sample, r)| {
            let (sin, cos) = (w * sample.time).sin_cos();
            (re + r * cos, im + r * sin)
        });
        re * re + im * im
    }
}

#[cfg(test)]
mod tests {
    use super::{NODES, Problem, TAU};
    use crate::estimators::Sample;
    use crate::learning::cause::Cause;
    use crate::learning::order::open_prior;
    use crate::learning::path::Way;
    use crate::learning::response::columns;

    const PERIOD: f64 = 0.004;
    /// Poles `R exp(+-i W)` of noise that is densest at 8 Hz.
    const R: f64 = 0.93;
    const W: f64 = TAU * 8.0 * PERIOD;

    /// Uniform numbers of variance 1 by a linear congruential generator (Knuth's MMIX).
    fn white(mut state: u64) -> impl FnMut() -> f64 {
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            12f64.sqrt() * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
        }
    }

    /// A mode of 8 Hz in a move of half a second and the second after it, without noise.
    fn moved(log_w: f64) -> Vec<Sample> {
        let position = |k: usize| {
            let s = (k as f64 * PERIOD / 0.5).min(1.0);
            0.3 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
        };
        let sample = |k: usize| Sample {
            time: k as f64 * PERIOD,
            motor_position: position(k),
            deformation: 0.0,
        };
        let mut samples: Vec<Sample> = (0..375).map(sample).collect();
        let [driven, ..] = columns(&samples, |_| log_w, 0.03, Cause::Stiffness).of;
        let each = samples.iter_mut().zip(driven);
        each.for_each(|(sample, q)| sample.deformation = q);
        samples
    }

    /// Error of the fitted `ln w` at the end over its standard deviation, squared, in noise around 8 Hz under twice as much white
    /// noise.
    fn surprise(seed: u64) -> f64 {
        let log_w = (TAU * 8.0).ln();
        let mut samples = moved(log_w);
        let (mut noise, mut push) = (white(2 * seed + 1), white(977 * seed + 500_000));
        let mut slow = [0.0; 2];
        for sample in &mut samples {
            slow = [
                2.0 * R * W.cos() * slow[0] - R * R * slow[1] + push(),
                slow[0],
            ];
            sample.deformation += 2e-5 * slow[0] + 2.7e-4 * noise();
        }
        let way = Way::new(0.0, 0.3);
        let prior = open_prior(log_w, &way.nodes(), 0.03);
        let mut problem = Problem::new(&samples, way, (3.0, 6.0), Cause::Stiffness);
        let fit = problem.fit(&[prior.point()], &[prior]).expect("a fit");
        let [mode] = fit.modes.as_slice() else {
            panic!("{} modes", fit.modes.len());
        };
        let end = NODES - 1;
        (mode.point.log_w[end] - log_w).powi(2) / mode.covariance[(end, end)]
    }

    /// Standard deviations are those of the errors where white noise hides vibration that the modes do not explain.
    #[test]
    fn val_errors_in_hidden_vibration_are_those_that_are_told() {
        let mean = (0..100).map(surprise).sum::<f64>() / 100.0;
        // The mean of 100 squares of a normal variable is within 1 +- 0.42 in three standard deviations.
        assert!((0.58..1.42).contains(&mean), "{mean}");
    }
}

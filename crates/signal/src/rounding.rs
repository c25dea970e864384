//! The error of a sensor that rounds, while it rests.

use std::f64::consts::PI;
use std::ops::Range;

/// Terms of the series. Without noise the variance is 2 % too small.
const TERMS: u32 = 30;
/// Width of a rest, in steps without noise: half a step allows for values that were computed from rounded ones.
const STEPS: f64 = 1.5;
/// The same in standard deviations of the noise, which are exceeded once in ten thousand samples.
const DEVIATIONS: f64 = 4.0;

/// A sensor that rounds values with white noise.
///
/// While it rests, the noise `sigma` moves it over the steps `q`, and the mean error of all samples is one number. Over all
/// places of the rest between two steps its variance is
///
/// ```text
/// sum over k of q^2 / (2 pi^2 k^2) exp(-4 pi^2 k^2 sigma^2 / q^2)
/// ```
///
/// which is `q^2 / 12` without noise, and nothing from `sigma = q` on. Source: Widrow and Kollar, Quantization Noise (2008),
/// chapter 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// Step `q`, in the unit of the values; positive.
    step: f64,
    /// Standard deviation `sigma` of the noise before it is rounded, in the same unit.
    noise: f64,
}

impl Rounding {
    /// Of a step and the standard deviation of the recorded values in motion, `level^2 = sigma^2 + q^2 / 12`; `None` without a
    /// step.
    pub fn of(step: f64, level: f64) -> Option<Self> {
        let noise = (level * level - step * step / 12.0).max(0.0).sqrt();
        (step > 0.0).then_some(Self { step, noise })
    }

    /// Standard deviation of the mean error of a rest.
    pub fn mean_error(&self) -> f64 {
        let noise = self.noise / self.step;
        let term = |k: u32| {
            let order = PI * f64::from(k);
            0.5 * (-(2.0 * order * noise).powi(2)).exp() / (order * order)
        };
        self.step * (1..=TERMS).map(term).sum::<f64>().sqrt()
    }

    /// Stretches of values that noise and rounding alone may move.
    pub fn rests(&self, values: &[f64]) -> Vec<Range<usize>> {
        let within = STEPS * self.step + DEVIATIONS * self.noise;
        let (mut found, mut start) = (Vec::new(), 0);
        for k in 1..=values.len() {
            if k == values.len() || (values[k] - values[start]).abs() >= within {
                found.push(start..k);
                start = k;
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng, rngs::StdRng};
    use rand_distr::StandardNormal;

    /// The mean error of rests at places that are uniform between two steps, in white noise of so many steps.
    #[test]
    fn val_the_mean_error_of_a_rest_in_noise() {
        let mut random = StdRng::seed_from_u64(3);
        for noise in [0.0, 0.1, 0.2, 0.3_f64] {
            let squares = (0..400).map(|k| {
                let place = (f64::from(k) + 0.5) / 400.0;
                let error = |_| {
                    let seen = place + noise * random.sample::<f64, _>(StandardNormal);
                    seen.round() - place
                };
                (0..4000).map(error).sum::<f64>() / 4000.0
            });
            let found = (squares.map(|mean| mean * mean).sum::<f64>() / 400.0).sqrt();
            let level = (noise * noise + 1.0 / 12.0).sqrt();
            let expected = Rounding::of(1.0, level).unwrap().mean_error();
            assert!(
                (found / expected - 1.0).abs() < 0.05,
                "{noise}: {found} {expected}"
            );
        }
    }

    /// A ramp has no rest; the two places of a sensor whose noise moves it over the steps are one rest each.
    #[test]
    fn rests_are_as_wide_as_noise_and_step() {
        let still = Rounding::of(1.0, 0.0).unwrap();
        let ramp: Vec<f64> = (0..4).map(|k| 2.0 * f64::from(k)).collect();
        assert_eq!(still.rests(&ramp), [0..1, 1..2, 2..3, 3..4]);
        let noisy = Rounding::of(1.0, 0.5).unwrap();
        let moved = [0.0, 1.0, 0.0, -1.0, 2.0, 1.0];
        let values: Vec<f64> = moved
            .into_iter()
            .chain(moved.map(|own| 9.0 + own))
            .collect();
        assert_eq!(noisy.rests(&values), [0..6, 6..12]);
        assert_eq!(Rounding::of(0.0, 1.0), None);
    }
}

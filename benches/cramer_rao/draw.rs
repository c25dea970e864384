//! Conditions at random.

use quell::estimators::{Bound, Sample, Settings, cramer_rao};
use quell_shapers::Mode;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

const RATES: [f64; 4] = [250.0, 1000.0 / 3.0, 1000.0, 4000.0];

/// A free decay that somebody measures.
pub struct Case {
    pub mode: Mode,
    pub amplitude: f64,
    pub phase: f64,
    pub noise: f64,
    pub rate: f64,
    pub belief: Mode,
    pub seed: u64,
}

impl Case {
    /// The case of a seed; frequencies, damping ratios, amplitudes and noises even in their logarithm.
    pub fn draw(seed: u64) -> Option<Self> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut between =
            |low: f64, high: f64| -> f64 { low * (high / low).powf(random.random::<f64>()) };
        let frequency_hz = between(1.0, 60.0);
        let belief = frequency_hz * between(0.75, 1.25);
        Some(Self {
            mode: Mode::from_hertz(frequency_hz, between(0.005, 0.15)).ok()?,
            amplitude: between(0.1e-3, 2e-3),
            noise: between(5e-6, 50e-6),
            belief: Mode::from_hertz(belief, between(0.005, 0.15)).ok()?,
            phase: random.random_range(0.0..core::f64::consts::TAU),
            rate: RATES[random.random_range(0..RATES.len())],
            seed,
        })
    }

    /// Whether the estimators are told the level of the noise.
    pub fn settings(&self, noise_is_known: bool) -> Settings {
        Settings {
            noise_std: noise_is_known.then_some(self.noise),
            offset_std: Some(0.0),
            ..Settings::around(self.belief, 1.0 / self.rate)
        }
    }

    /// The decay without noise, the motor side at 30 degrees.
    pub fn clean(&self, periods: f64) -> Vec<Sample> {
        let count = (self.rate * periods / self.mode.hertz()).round() as usize;
        let envelope = |time: f64| self.amplitude * (-self.mode.decay_rate() * time).exp();
        (0..count)
            .map(|k| k as f64 / self.rate)
            .map(|time| Sample {
                time,
                motor_position: 30f64.to_radians(),
                deformation: envelope(time)
                    * (self.mode.damped_frequency() * time + self.phase).cos(),
            })
            .collect()
    }

    /// The decay as it is measured.
    pub fn measured(&self, periods: f64) -> Vec<Sample> {
        let mut random = ChaCha8Rng::seed_from_u64(!self.seed);
        let mut samples = self.clean(periods);
        for sample in &mut samples {
            let noise: f64 = StandardNormal.sample(&mut random);
            sample.deformation += self.noise * noise;
        }
        samples
    }

    /// The bound, as standard deviations of `ln w` and `xi`.
    pub fn bound(&self, clean: &[Sample]) -> Option<[f64; 2]> {
        let Bound {
            natural_frequency_std,
            damping_ratio_std,
        } = cramer_rao(clean, self.mode, self.noise, &self.settings(true))?;
        let bound = [
            natural_frequency_std / self.mode.natural_frequency(),
            damping_ratio_std,
        ];
        bound.iter().all(|std| std.is_finite()).then_some(bound)
    }

    /// Errors of `ln w` and `xi`.
    pub fn error(&self, found: Mode) -> [f64; 2] {
        [
            (found.natural_frequency() / self.mode.natural_frequency()).ln(),
            found.damping_ratio() - self.mode.damping_ratio(),
        ]
    }
}

//! One mode in a free decay: its amplitude and its phase over time.
//!
//! `z(t) = a(t) e^(j W(t))` with `a = e^(-s t)`, `W = w t` for a linear mode. Where a mode depends on a power `p` of its
//! amplitude, `W = w t + w b v` and `a = e^(-s (t + d v))`, with `v = (1 - e^(-p s t)) / (p s)`; under dry friction
//! `a = (1 + d) e^(-s t) - d` until it rests, with `p = 1` in its phase.

use nalgebra::Complex;

/// Samples after which a linear mode is computed anew: in between it is turned from sample to sample, and rounding
/// grows by one place of it a sample.
const ANEW: usize = 64;

/// One mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damped {
    /// Damped angular frequency, rad/s; at small amplitude.
    pub frequency: f64,
    /// Decay rate, 1/s; at small amplitude.
    pub rate: f64,
    /// Dependence on the amplitude, where it has one.
    pub bend: Option<Bend>,
}

/// Dependence of a mode on its amplitude: relative differences of frequency and rate at the start of a decay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// Of the frequency.
    pub frequency: f64,
    /// Of the rate.
    pub rate: f64,
    /// The law that it follows.
    pub law: Law,
}

/// The law of a mode's frequency and rate over the amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// A power of the amplitude: 1 for clamps and material, 2 for geometry and drag.
    Power(f64),
    /// The rate follows one over the amplitude, as under dry friction; the frequency follows the amplitude.
    Friction,
}

impl Law {
    fn power(self) -> f64 {
        match self {
            Self::Power(power) => power,
            Self::Friction => 1.0,
        }
    }
}

impl Damped {
    /// Number of its unknowns besides its amplitudes.
    pub fn unknowns(&self) -> usize {
        2 + 2 * usize::from(self.bend.is_some())
    }

    /// Amplitude and phase, rad, at a time, s.
    fn at(&self, time: f64) -> [f64; 2] {
        let (phase, decay) = (self.frequency * time, self.rate * time);
        let Some(bend) = self.bend else {
            return [(-decay).exp(), phase];
        };
        let speed = bend.law.power() * self.rate;
        let away = -(-speed * time).exp_m1() / speed;
        let amplitude = match bend.law {
            Law::Power(_) => (-decay - bend.rate * self.rate * away).exp(),
            Law::Friction => ((1.0 + bend.rate) * (-decay).exp() - bend.rate).max(0.0),
        };
        [amplitude, phase + bend.frequency * self.frequency * away]
    }

    /// The mode at each multiple of a period, s, from 0 on.
    pub fn over(self, period: f64) -> impl Iterator<Item = Complex<f64>> {
        let value = move |sample: usize| {
            let [amplitude, phase] = self.at(sample as f64 * period);
            Complex::from_polar(amplitude, phase)
        };
        let turn = Complex::from_polar((-self.rate * period).exp(), self.frequency * period);
        let mut now = Complex::new(0.0, 0.0);
        (0..).map(move |sample| {
            now = match self.bend.is_some() || sample % ANEW == 0 {
                true => value(sample),
                false => now * turn,
            };
            now
        })
    }

    /// Logarithmic derivatives `z' / z = a' / a + j W'` at a time, s, after the logarithms of frequency and rate, and
    /// after its bend's frequency and rate (0 without one). A mode at rest stays there.
    pub fn slopes(&self, time: f64) -> [Complex<f64>; 4] {
        let (phase, decay) = (self.frequency * time, self.rate * time);
        let none = Complex::new(0.0, 0.0);
        let Some(bend) = self.bend else {
            return [
                Complex::new(0.0, phase),
                Complex::new(-decay, 0.0),
                none,
                none,
            ];
        };
        let speed = bend.law.power() * self.rate;
        let away = -(-speed * time).exp_m1() / speed;
        // Of `v` after the logarithm of the rate.
        let sooner = time * (-speed * time).exp() - away;
        let (by_rate, by_bend) = match bend.law {
            Law::Power(_) => (
                decay + bend.rate * self.rate * (away + sooner),
                self.rate * away,
            ),
            Law::Friction => {
                let left = (1.0 + bend.rate) * (-decay).exp() - bend.rate;
                if left <= 0.0 {
                    return [none; 4];
                }
                let by_rate = (1.0 + bend.rate) * decay * (-decay).exp();
                (by_rate / left, -(-decay).exp_m1() / left)
            }
        };
        let [by_frequency, turned] = [away, sooner].map(|over| self.frequency * over);
        [
            Complex::new(0.0, phase + bend.frequency * by_frequency),
            Complex::new(-by_rate, bend.frequency * turned),
            Complex::new(0.0, by_frequency),
            Complex::new(-by_bend, 0.0),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slopes are those of central differences, of each law, before and after rest.
    #[test]
    fn slopes_of_every_law() {
        let laws = [
            None,
            Some(Law::Power(1.0)),
            Some(Law::Power(2.0)),
            Some(Law::Friction),
        ];
        for (law, time) in laws
            .into_iter()
            .flat_map(|law| [0.0, 0.3, 1.1, 9.0].map(|t| (law, t)))
        {
            let bend = law.map(|law| Bend {
                frequency: -0.03,
                rate: 0.2,
                law,
            });
            let mode = Damped {
                frequency: 3.0,
                rate: 0.4,
                bend,
            };
            let beside = |which: usize, by: f64| {
                let mut other = mode;
                match (which, &mut other.bend) {
                    (0, _) => other.frequency *= by.exp(),
                    (1, _) => other.rate *= by.exp(),
                    (2, Some(bend)) => bend.frequency += by,
                    (3, Some(bend)) => bend.rate += by,
                    _ => {}
                }
                let [amplitude, phase] = other.at(time);
                Complex::from_polar(amplitude, phase)
            };
            for (which, slope) in mode.slopes(time).into_iter().enumerate() {
                let slope = slope * beside(which, 0.0);
                let difference = (beside(which, 1e-5) - beside(which, -1e-5)) / 2e-5;
                assert!(
                    (difference - slope).norm() < 1e-6,
                    "{law:?} at {time}: {which}"
                );
            }
        }
    }

    /// Turned from sample to sample it is what it is at each time.
    #[test]
    fn turned_is_computed() {
        let mode = Damped {
            frequency: 311.0,
            rate: 1.7,
            bend: None,
        };
        for (sample, turned) in mode.over(1e-3).take(5000).enumerate() {
            let [amplitude, phase] = mode.at(sample as f64 * 1e-3);
            assert!((turned - Complex::from_polar(amplitude, phase)).norm() <= 1e-12 * amplitude);
        }
    }
}

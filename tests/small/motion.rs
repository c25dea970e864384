//! The motion of a joint of one mode that makes moves, by Euler's rule in steps so small that it errs by less than the
//! noise.

use std::f64::consts::TAU;

/// Steps between two samples.
const STEPS: u32 = 200;

/// The joint, and how it is sampled.
pub struct Joint {
    /// Natural frequency, rad/s.
    pub frequency: f64,
    /// Damping ratio.
    pub damping: f64,
    /// Samples a second.
    pub rate: f64,
    /// Number of samples.
    pub samples: u32,
    /// Amplitude of the acceleration of a move of size 1, rad/s^2.
    pub acceleration: f64,
}

impl Joint {
    /// Motor position and deformation at each sample, rad; moves by start, length and size, on a base that is moved with
    /// an acceleration.
    pub fn motion(&self, moves: &[(f64, f64, f64)], base: impl Fn(f64) -> f64) -> Vec<[f64; 2]> {
        let (w, xi) = (self.frequency, self.damping);
        let h = 1.0 / (self.rate * f64::from(STEPS));
        let [mut x, mut v, mut u, mut speed] = [0.0_f64; 4];
        let mut samples = Vec::new();
        for sample in 0..self.samples {
            samples.push([u, x]);
            for step in 0..STEPS {
                let time = f64::from(sample * STEPS + step) * h;
                let input: f64 = moves.iter().map(|own| self.pulse(*own, time)).sum();
                v += h * (-w * w * x - 2.0 * xi * w * v - input - base(time));
                x += h * v;
                speed += h * input;
                u += h * speed;
            }
        }
        samples
    }

    /// One period of a sine.
    fn pulse(&self, (start, length, size): (f64, f64, f64), time: f64) -> f64 {
        let phase = (time - start) / length;
        match (0.0..1.0).contains(&phase) {
            true => self.acceleration * size * (TAU * phase).sin(),
            false => 0.0,
        }
    }
}

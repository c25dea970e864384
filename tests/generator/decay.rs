//! Exact free decays of one mode, for tests and benches.

use crate::generator::Truth;
use quell::estimators::Sample;
use std::f64::consts::TAU;

/// A free decay that begins with `amplitude` and a phase, the motor side at 30 degrees.
pub fn decay(truth: &Truth, amplitude: f64, phase: f64, times: &[f64]) -> Vec<Sample> {
    let w = TAU * truth.frequency_hz;
    let xi = truth.damping_ratio;
    let wd = w * (1.0 - xi * xi).sqrt();
    times
        .iter()
        .map(|&time| Sample {
            time,
            motor_position: 30f64.to_radians(),
            deformation: amplitude * (-xi * w * time).exp() * (wd * time + phase).cos(),
        })
        .collect()
}

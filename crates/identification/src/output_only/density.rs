//! The power spectral density of a vibration, in bands of equal relative width.

use super::Vibration;
use std::f64::consts::PI;

/// Power over frequency, of all axes together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Density {
    /// Centre of each band, Hz.
    pub frequency: Vec<f64>,
    /// One-sided density there, squared unit a hertz.
    pub power: Vec<f64>,
    /// Lines of the transform that are averaged in it.
    pub lines: Vec<f64>,
    /// Distance of the lines that are independent, Hz.
    pub resolution: f64,
}

/// The density between two frequencies, Hz, in bands whose width is a share of their frequency, at least a line each.
///
/// `tapered` weighs the samples by Hann's window, as a vibration that goes on at both ends needs it; what begins and ends
/// at rest is left as it is: its transform is the excitation's times the response, without a smear.
pub fn density(vibration: &Vibration, [from, to]: [f64; 2], width: f64, tapered: bool) -> Density {
    let samples = vibration.axes[0].len();
    let length = samples.next_power_of_two();
    let spacing = vibration.rate / length as f64;
    let resolution = vibration.rate / samples as f64;
    let mut power = vec![0.0; length / 2 + 1];
    let window = |k: usize| match tapered {
        true => (PI * (k as f64 + 0.5) / samples as f64).sin().powi(2),
        false => 1.0,
    };
    let weight: f64 = (0..samples).map(|k| window(k).powi(2)).sum();
    for axis in &vibration.axes {
        let mean = axis.iter().sum::<f64>() / samples as f64;
        let mut values: Vec<f64> = axis
            .iter()
            .enumerate()
            .map(|(k, v)| window(k) * (v - mean))
            .collect();
        values.resize(length, 0.0);
        for (sum, line) in power.iter_mut().zip(quell_signal::fourier(values)) {
            *sum += 2.0 * line.norm_sqr() / (vibration.rate * weight);
        }
    }
    let mut density = Density {
        resolution,
        ..Density::default()
    };
    let mut first = (from / spacing).ceil().max(1.0) as usize;
    let last = ((to / spacing) as usize).min(length / 2);
    while first <= last {
        let band = (first as f64 * (1.0 + width))
            .max(first as f64 + resolution / spacing)
            .round();
        let until = (band as usize).min(last + 1).max(first + 1);
        let lines = (until - first) as f64;
        density
            .frequency
            .push(spacing * (first + until - 1) as f64 / 2.0);
        density
            .power
            .push(power[first..until].iter().sum::<f64>() / lines);
        // Lines closer than the record resolves are one.
        density.lines.push((lines * spacing / resolution).max(1.0));
        first = until;
    }
    density
}

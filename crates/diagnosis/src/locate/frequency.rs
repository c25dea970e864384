//! Frequencies that stand out of the residual.

use super::peaks::lines;
use super::{Dynamics, MOST};
use quell_signal::{Window, spectrum};

/// Distance from the mode, relative, within which a peak is the mode's own.
const NEAR: f64 = 0.15;
/// Most peaks near the mode that are named: any mismatch makes the mode ring.
const MOST_NEAR: usize = 2;

/// Angular frequencies, rad/s, the strongest first.
pub(super) fn frequencies(time: &[f64], residual: &[f64], dynamics: &Dynamics) -> Vec<f64> {
    let n = time.len();
    let period = (time[n - 1] - time[0]) / (n - 1) as f64;
    let Ok(spectrum) = spectrum(&even(time, residual, period), period, Window::Hann, 1) else {
        return Vec::new();
    };
    let power: Vec<f64> = spectrum.amplitude.iter().map(|a| a * a).collect();
    // A Hann peak is four lines of the unpadded length wide.
    let width = 4.0 * std::f64::consts::TAU / (n as f64 * period);
    let first = (width / spectrum.resolution).ceil() as usize;
    let mut found: Vec<f64> = Vec::new();
    let mut near = 0;
    for line in lines(&power, first, power.len()) {
        let frequency = line.at * spectrum.resolution;
        let apart = |known: &f64| (known - frequency).abs() > width.max(0.05 * frequency);
        let is_near = is_near(frequency, dynamics);
        if found.len() < MOST && found.iter().all(apart) && !(is_near && near == MOST_NEAR) {
            near += usize::from(is_near);
            found.push(frequency);
        }
    }
    found
}

/// Whether a frequency is the mode's.
pub(super) fn is_near(frequency: f64, dynamics: &Dynamics) -> bool {
    let mode = dynamics.natural_frequency;
    (frequency - mode).abs() <= NEAR * mode
}

/// The series on an even clock, straight lines between stamps.
fn even(time: &[f64], values: &[f64], period: f64) -> Vec<f64> {
    let mut k = 0;
    (0..time.len())
        .map(|i| {
            let t = time[0] + period * i as f64;
            while k + 2 < time.len() && time[k + 1] < t {
                k += 1;
            }
            let share = ((t - time[k]) / (time[k + 1] - time[k])).clamp(0.0, 1.0);
            values[k] + share * (values[k + 1] - values[k])
        })
        .collect()
}

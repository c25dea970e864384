//! The power spectral density of a vibration, in bands of equal relative width.

use super::Vibration;
use quell_signal::Window;

/// Number of lines of a Hann window per independent one, for averages over many: `sum w^4 N / (sum w^2)^2`.
const SMEARED: f64 = 35.0 / 18.0;
/// Lines on either side whose median is the reference of a line, and the ratio above which it is not noise:
/// noise exceeds it once in 2^40 lines.
const BESIDE: usize = 8;
const OF_NO_NOISE: f64 = 40.0;
/// Lines on either side over which Hann's window spreads a sine.
const SPREAD: usize = 3;

/// How a density is taken of a record.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Taken {
    /// Without a window: a record that begins and ends at rest needs none, as its transform is the excitation's times the
    /// response, without leakage.
    Untapered,
    /// With Hann's window, as needed for a vibration that continues at both ends.
    Tapered,
    /// The same, without the lines of rotation at constant speed. The line of a mode that rings in a short record is as thin, so
    /// this is not what a picture shows.
    WithoutSines,
}

/// Power over frequency, of all axes together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Density {
    /// Centre of each band, Hz.
    pub frequency: Vec<f64>,
    /// One-sided density there, squared unit per hertz.
    pub power: Vec<f64>,
    /// Independent lines of the record that it is worth; below 1 where neighbouring bands share one.
    pub lines: Vec<f64>,
    /// Distance of independent lines, Hz.
    pub resolution: f64,
}

/// The density between two frequencies, Hz, in bands of constant relative width with at least one line each.
pub fn density(vibration: &Vibration, [from, to]: [f64; 2], width: f64, taken: Taken) -> Density {
    let samples = vibration.axes[0].len();
    let length = samples.next_power_of_two();
    let spacing = vibration.rate / length as f64;
    let resolution = vibration.rate / samples as f64;
    let mut power = vec![0.0; length / 2 + 1];
    let tapered = taken != Taken::Untapered;
    let window = match tapered {
        true => Window::Hann,
        false => Window::Rectangular,
    };
    let window = |k: usize| window.weight(k, samples);
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
    let finer = (resolution / spacing).round().max(1.0) as usize;
    let of_sines = match taken {
        Taken::WithoutSines => sines(&power, finer),
        _ => vec![false; power.len()],
    };
    let mut density = Density {
        resolution,
        ..Density::default()
    };
    let mut first = (from / spacing).ceil().max(1.0) as usize;
    let last = ((to / spacing) as usize).min(length / 2);
    while first <= last {
        let band = (first as f64 * (1.0 + width))
            .max((first + finer) as f64)
            .round();
        let until = (band as usize).min(last + 1).max(first + 1);
        let kept: Vec<usize> = (first..until).filter(|line| !of_sines[*line]).collect();
        let place = (first + until - 1) as f64 / 2.0;
        first = until;
        if kept.is_empty() {
            continue;
        }
        let lines = kept.len() as f64;
        density.frequency.push(spacing * place);
        density
            .power
            .push(kept.iter().map(|line| power[*line]).sum::<f64>() / lines);
        // Neighbours closer than the resolution of the record, or smeared by the window, say the same.
        let independent = lines * spacing / resolution / if tapered { SMEARED } else { 1.0 };
        density.lines.push(independent);
    }
    density
}

impl Density {
    /// Expected sum of the bands' deviances about their true density, `2 M (ln s - psi(s))` each: of a gamma density of shape
    /// `s = max(M, 1)`, as a single line has an exponential one. `ln s - psi(s)` is about `1 / 2 s + 1 / 12 s^2`; at 1 it is
    /// Euler's constant.
    pub fn chance(&self) -> f64 {
        let band = |lines: &f64| 2.0 * lines * ln_over_digamma(lines.max(1.0));
        self.lines.iter().map(band).sum()
    }
}

/// `ln x - psi(x)`, from 1: to 1e-6 by `psi(x) = psi(x + 1) - 1 / x` and the asymptotic series from 4 on.
///
/// Source: NIST Digital Library of Mathematical Functions, 5.5.2 and 5.11.2.
fn ln_over_digamma(x: f64) -> f64 {
    let (mut at, mut below) = (x, 0.0);
    while at < 4.0 {
        below += 1.0 / at;
        at += 1.0;
    }
    let square = 1.0 / (at * at);
    let series = 0.5 / at + square * (1.0 / 12.0 - square * (1.0 / 120.0 - square / 252.0));
    x.ln() - at.ln() + series + below
}

/// Lines of rotation at constant speed, with their neighbours: they exceed the surrounding lines by more than
/// noise does. In a padded transform `finer` lines correspond to one of the record.
fn sines(power: &[f64], finer: usize) -> Vec<bool> {
    let (beside, spread) = (BESIDE * finer, SPREAD * finer);
    let mut found = vec![false; power.len()];
    for centre in beside..power.len().saturating_sub(beside) {
        let around = &power[centre - beside..=centre + beside];
        let is_top = around.iter().all(|other| *other <= power[centre]);
        if !is_top {
            continue;
        }
        let mut around = around.to_vec();
        let median = *around.select_nth_unstable_by(beside, f64::total_cmp).1;
        if power[centre] > OF_NO_NOISE * median {
            found[centre - spread..=centre + spread].fill(true);
        }
    }
    found
}

//! Steady vibrations at rest: lines that stand out of a rest's spectrum.
//!
//! A fan or a pump is no noise: one sine explains it through the whole recording. Hum below the noise is a part of it. In
//! noise of a smooth spectrum the power of a line over the mean of `n` independent lines beside it has an F distribution of 2
//! and 2 n degrees of freedom, which exceeds `x` with the probability `(1 + x / n)^-n`. Source: Priestley, Spectral Analysis
//! and Time Series (1981), section 6.1.4; Fisher, Proc. Royal Society A 125 (1929).

use quell_signal::{Window, golden_section, spectrum};
use std::f64::consts::PI;

/// Probability that any line of a rest stands out by chance.
const CHANCE: f64 = 1e-4;
/// Independent lines on each side whose mean is the density of the noise.
const BESIDE: f64 = 10.0;
/// Half the width of a line under Hann's window, and the width of the band that one line sees, in lines that are independent
/// without a window.
const WIDTH: [f64; 2] = [2.0, 1.5];
/// Least periods in a rest; fewer are a drift.
const LEAST_PERIODS: f64 = 4.0;
/// Most lines of a rest.
const MOST: usize = 8;
/// Steps of the search for a frequency: to a thousandth of the distance of two lines.
const SECTIONS: usize = 16;

/// A rest without the vibrations that are steady in it, where it is mostly these.
pub fn without_lines(rest: Vec<f64>) -> Vec<f64> {
    let mut left = rest.clone();
    for _ in 0..MOST {
        match line(&left) {
            Some(frequency) => left = without(&left, frequency),
            None => break,
        }
    }
    match power(&left) < 0.5 * power(&rest) {
        true => left,
        false => rest,
    }
}

fn power(values: &[f64]) -> f64 {
    values.iter().map(|own| own * own).sum()
}

/// Angle a sample of the line that stands out most, if any does.
fn line(rest: &[f64]) -> Option<f64> {
    let lines = spectrum(&flat(rest), 1.0, Window::Hann, 1).ok()?;
    let powers: Vec<f64> = lines.amplitude.iter().map(|own| own * own).collect();
    // Of the lines of a padded spectrum only each `padding`th is independent.
    let padding = 2.0 * PI / (lines.resolution * rest.len() as f64);
    let [apart, side] =
        [WIDTH[0], WIDTH[0] + BESIDE * WIDTH[1]].map(|own| (own * padding).ceil() as usize);
    let first = (LEAST_PERIODS * padding).ceil() as usize;
    let count = (powers.len().saturating_sub(first)) as f64 / padding;
    let beyond = |k: usize| {
        let below = first..k.saturating_sub(apart).max(first);
        let above = (k + apart + 1).min(powers.len())..powers.len();
        let below = below.rev().take(side - apart);
        let beside: Vec<f64> = below
            .chain(above.take(side - apart))
            .map(|i| powers[i])
            .collect();
        let mean = beside.iter().sum::<f64>() / beside.len() as f64;
        let n = beside.len() as f64 / (WIDTH[1] * padding);
        -n * (powers[k] / (mean * n)).ln_1p()
    };
    let least = (first..powers.len()).map(|k| (beyond(k), k));
    let (logarithm, k) = least.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let stands_out = logarithm + count.ln() < CHANCE.ln();
    let near = [-1.0, 1.0].map(|by| (k as f64 + by * padding) * lines.resolution);
    stands_out.then(|| golden_section(|own| power(&without(rest, own)), near, SECTIONS).0)
}

/// The values less what one pole foretells of each, so that slow noise has a flat spectrum.
fn flat(values: &[f64]) -> Vec<f64> {
    let product = |lag: usize| {
        values[lag..]
            .iter()
            .zip(values)
            .map(|(a, b)| a * b)
            .sum::<f64>()
    };
    let pole = product(1) / product(0).max(f64::MIN_POSITIVE);
    values
        .windows(2)
        .map(|pair| pair[1] - pole * pair[0])
        .collect()
}

/// The values without the sine of this angle a sample, by least squares.
fn without(rest: &[f64], frequency: f64) -> Vec<f64> {
    let waves: Vec<[f64; 2]> = (0..rest.len())
        .map(|k| (frequency * k as f64).sin_cos().into())
        .collect();
    let sum = |of: &dyn Fn(usize) -> f64| (0..rest.len()).map(of).sum::<f64>();
    let product = |i: usize, j: usize| sum(&|k| waves[k][i] * waves[k][j]);
    let [ss, sc, cc] = [product(0, 0), product(0, 1), product(1, 1)];
    let [s, c] = [0, 1].map(|i| sum(&|k| waves[k][i] * rest[k]));
    let determinant = ss * cc - sc * sc;
    if determinant <= f64::EPSILON * ss * cc {
        return rest.to_vec();
    }
    let [a, b] = [
        (cc * s - sc * c) / determinant,
        (ss * c - sc * s) / determinant,
    ];
    let pairs = rest.iter().zip(&waves);
    pairs
        .map(|(own, [sin, cos])| own - a * sin - b * cos)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::whitening::Whitening;
    use super::*;
    use rand::SeedableRng;

    /// Two loud sines go, a quiet one stays; white noise and noise of one pole stay whole.
    #[test]
    fn sines_go_and_noise_stays() {
        let slow = Whitening::one_pole(0.9, 0.19_f64.sqrt());
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        for length in [300, 700, 2500] {
            for own in [Whitening::white(1.0), slow.clone()] {
                for _ in 0..50 {
                    let noise = own.draw(length, &mut random);
                    assert_eq!(without_lines(noise.clone()), noise, "{length}");
                    let shaken = |size: f64| -> Vec<f64> {
                        let wave = |k: f64| 4.0 * (0.31 * k + 1.0).sin() + 3.0 * (1.3 * k).sin();
                        let samples = noise.iter().enumerate();
                        samples
                            .map(|(k, own)| own + size * wave(k as f64))
                            .collect()
                    };
                    let ratio = power(&without_lines(shaken(1.0))) / power(&noise);
                    assert!((0.7..1.2).contains(&ratio), "{length}: {ratio}");
                    assert_eq!(without_lines(shaken(0.1)), shaken(0.1));
                }
            }
        }
    }
}

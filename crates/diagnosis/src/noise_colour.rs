//! Colour of the noise without rest: from frequencies at which the motion has no energy.
//!
//! A mode responds to a motion with the inverse square of the frequency, and the model's error falls faster
//! still; noise does not fall. Above a few natural frequencies the logarithm of the residual's periodogram is
//! thus that of the noise's spectrum, plus an error of known distribution. With one pole the spectrum is `S =
//! sigma^2 / |1 - a exp(-i w)|^2`. Level and pole follow by least absolute deviations, which are robust against
//! narrow peaks (a further mode, mains hum).
//!
//! Source: Brockwell and Davis, Time Series: Theory and Methods (1991), section 10.3, for the
//! distribution of a periodogram.

use super::whitening::Whitening;
use quell_signal::{Window, spectrum};
use std::f64::consts::TAU;

/// Natural frequencies above which the residual is noise: the response has fallen to a tenth.
const ABOVE: f64 = 3.0;
/// Fewest spectral lines that determine a pole.
const FEWEST: usize = 100;
/// Median of the logarithm of a periodogram over its mean: that of an exponential variable.
const MEDIAN: f64 = -0.366_513;
/// Poles that are tried.
const POLES: usize = 20;
/// Largest pole; slower noise is drift.
const SLOWEST: f64 = 0.95;

/// Noise of one pole; white where a pole explains no more; `None` where the samples are too few or too slow.
/// `period` is that of the samples, s; `frequency` the natural one, rad/s.
pub fn colour(residual: &[f64], period: f64, frequency: f64) -> Option<Whitening> {
    let lines = spectrum(residual, period, Window::Hann, 1).ok()?;
    let n = residual.len() as f64;
    // The power of white noise with variance 1 under this window is 1.
    let window = 3.0 / 8.0;
    let power = |amplitude: f64| (0.5 * amplitude).powi(2) * n * 0.25 / window;
    let first = (ABOVE * frequency / lines.resolution).ceil() as usize;
    let last = lines.amplitude.len().checked_sub(1)?;
    let band: Vec<(f64, f64)> = (first..last)
        .map(|k| (k as f64 * lines.resolution * period, lines.amplitude[k]))
        .filter(|(_, amplitude)| *amplitude > 0.0)
        .map(|(w, amplitude)| (w, power(amplitude).ln()))
        .collect();
    if band.len() < FEWEST {
        return None;
    }
    let white = fit(&band, 0.0);
    let poles = (1..=POLES).map(|k| SLOWEST * k as f64 / POLES as f64);
    let fits = poles.map(|pole| (pole, fit(&band, pole)));
    let (pole, found) = fits.min_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
    // Schwarz's criterion for Laplace-distributed errors, which match least absolute deviations. Spectral lines
    // are independent without padding.
    let count = band.len() as f64 * (TAU / (lines.resolution * period) / n).recip().min(1.0);
    let better = 2.0 * count * (white.1 / found.1).ln() > count.ln();
    Some(match better {
        true => Whitening::one_pole(pole, found.0),
        false => Whitening::white(white.0),
    })
}

/// Standard deviation of the innovation, and the mean absolute deviation, with a pole.
fn fit(band: &[(f64, f64)], pole: f64) -> (f64, f64) {
    let shape = |w: f64| (1.0 - 2.0 * pole * w.cos() + pole * pole).ln();
    let mut left: Vec<f64> = band.iter().map(|(w, power)| power + shape(*w)).collect();
    left.sort_by(f64::total_cmp);
    let median = left[left.len() / 2];
    let spread = left.iter().map(|x| (x - median).abs()).sum::<f64>();
    (((median - MEDIAN) / 2.0).exp(), spread / left.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    #[test]
    fn a_pole_is_found_under_a_mode_and_none_in_white_noise() {
        let truth = Whitening::one_pole(0.5, 2.0);
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        for (truth, poles) in [(truth, 1), (Whitening::white(2.0), 0)] {
            let ringing = |t: f64| 300.0 * (-t).exp() * (50.0 * t).sin();
            let noise = truth.draw(4000, &mut random);
            let residual = noise.iter().enumerate();
            let residual: Vec<f64> = residual
                .map(|(k, e)| e + ringing(0.003 * k as f64))
                .collect();
            let found = colour(&residual, 0.003, 50.0).unwrap();
            assert_eq!(found.coefficients.len(), poles, "{found:?}");
            assert!((found.innovation / 2.0 - 1.0).abs() < 0.06, "{found:?}");
            assert!(
                (found.deviation / truth.deviation - 1.0).abs() < 0.1,
                "{found:?}"
            );
        }
    }
}

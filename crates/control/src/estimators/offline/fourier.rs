//! The Fourier transform of a free decay, and its mode from the bins around the peak.

use core::f64::consts::TAU;

use nalgebra::{Complex, Matrix3, Vector3};
use quell_shapers::Mode;

use crate::estimators::Sample;

/// `int (delta - mean) e^(-j w t) dt` over the samples by trapezoids, whatever their spacing.
fn transform(samples: &[Sample], mean: f64, w: f64) -> Complex<f64> {
    let value = |s: &Sample| {
        let turn = -w * (s.time - samples[0].time);
        Complex::from_polar(s.deformation - mean, turn)
    };
    samples
        .windows(2)
        .map(|pair| (value(&pair[0]) + value(&pair[1])) * (0.5 * (pair[1].time - pair[0].time)))
        .sum()
}

/// Amplitude of the deformation's Fourier transform at these frequencies (rad/s), scaled so that a
/// steady `A cos w t` shows `A`.
pub fn amplitude_spectrum(samples: &[Sample], frequencies: &[f64]) -> Vec<f64> {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return vec![0.0; frequencies.len()];
    };
    let mean = mean(samples);
    let scale = 2.0 / (last.time - first.time).max(f64::MIN_POSITIVE);
    frequencies
        .iter()
        .map(|&w| scale * transform(samples, mean, w).norm())
        .collect()
}

/// Mean over the last half, where the decay is smallest.
fn mean(samples: &[Sample]) -> f64 {
    let tail = &samples[samples.len() / 2..];
    tail.iter().map(|s| s.deformation).sum::<f64>() / tail.len().max(1) as f64
}

/// The mode of a free decay from five bins of its Fourier transform around the peak.
///
/// Over a window `T` the bins `w_k = 2 pi k / T` of `C e^(lambda t)` are exactly
/// `X_k = C (e^(lambda T) - 1) / (lambda - j w_k)`, so
/// `j w_k X_k = lambda X_k + c + b j w_k` with a constant background `b` (the image at negative
/// frequencies) is linear in `lambda`: neither the leakage of the window nor a half-power width
/// that it widens enters. Peaks are looked for in the range (rad/s).
///
/// Source: the interpolated transform of M. Bertocco, C. Offelli, D. Petri, IEEE Trans. Instrum.
/// Meas. 43 (1994), here by least squares with a background.
pub fn fourier(samples: &[Sample], range: (f64, f64)) -> Option<Mode> {
    let duration = samples.last()?.time - samples.first()?.time;
    if samples.len() < 8 || duration <= 0.0 {
        return None;
    }
    let mean = mean(samples);
    let bin = TAU / duration;
    let sample_time = duration / (samples.len() - 1) as f64;
    let highest = (0.9 * core::f64::consts::PI / sample_time).min(range.1);
    let bins = (highest / bin).floor() as usize;
    let first = ((range.0 / bin).floor() as usize).max(1);
    let peak = (first..=bins)
        .map(|k| (k, transform(samples, mean, k as f64 * bin).norm()))
        .max_by(|a, b| a.1.total_cmp(&b.1))?
        .0;
    let j = Complex::new(0.0, 1.0);
    let mut normal = Matrix3::<Complex<f64>>::zeros();
    let mut rhs = Vector3::<Complex<f64>>::zeros();
    for k in peak.saturating_sub(2).max(1)..=peak + 2 {
        let w = k as f64 * bin;
        let x = transform(samples, mean, w);
        let row = Vector3::new(x, Complex::new(bin.recip(), 0.0), j * (w / bin / bin));
        normal += row.conjugate() * row.transpose();
        rhs += row.conjugate() * (j * w * x);
    }
    let lambda = normal.lu().solve(&rhs)?[0];
    let w = lambda.norm();
    Mode::new(w, (-lambda.re / w).max(0.0)).ok()
}

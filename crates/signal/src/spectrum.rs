//! Amplitude spectrum of an evenly sampled signal.

use std::f64::consts::{PI, TAU};

use super::{SignalError, fourier};

/// Weight of the samples before the Fourier transform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// All alike: narrowest peak, leaks far.
    Rectangular,
    /// `sin^2`: a peak twice as wide, leakage that falls with the third power.
    Hann,
}

impl Window {
    /// Weight of sample `k` of `n`.
    pub fn weight(self, k: usize, n: usize) -> f64 {
        match self {
            Self::Rectangular => 1.0,
            Self::Hann => (PI * (k as f64 + 0.5) / n as f64).sin().powi(2),
        }
    }
}

/// A peak of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Angular frequency, rad/s.
    pub frequency: f64,
    /// Amplitude, in the signal's unit.
    pub amplitude: f64,
}

/// One-sided amplitude spectrum: a sine of amplitude `A` shows as `A`.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    /// Angular frequency between neighbouring lines, rad/s.
    pub resolution: f64,
    /// Amplitude at `0, resolution, 2 resolution...`, in the signal's unit.
    pub amplitude: Vec<f64>,
}

/// Spectrum of `values` (mean removed) with a sampling period of `period` s.
///
/// The signal is padded with zeros to `padding` times its length or more (a power of two). This interpolates
/// between the lines but does not improve the resolution.
///
/// # Errors
/// [`SignalError`] for fewer than 4 samples, a value that is not finite or a period that is not above
/// 0.
///
/// # Example
/// ```
/// use quell_signal::{Window, spectrum};
/// let wave: Vec<f64> = (0..1000).map(|k| 0.7 * (51.0 * 0.003 * k as f64).sin()).collect();
/// let peak = spectrum(&wave, 0.003, Window::Hann, 4).unwrap().peak(10.0, 200.0).unwrap();
/// assert!((peak.frequency - 51.0).abs() < 0.05 && (peak.amplitude - 0.7).abs() < 0.01);
/// ```
pub fn spectrum(
    values: &[f64],
    period: f64,
    window: Window,
    padding: usize,
) -> Result<Spectrum, SignalError> {
    let n = values.len();
    check(values, period)?;
    let mean = values.iter().sum::<f64>() / n as f64;
    let weight = |k: usize| window.weight(k, n);
    let length = (n * padding.max(1)).next_power_of_two();
    let mut signal: Vec<f64> = values
        .iter()
        .enumerate()
        .map(|(k, x)| weight(k) * (x - mean))
        .collect();
    signal.resize(length, 0.0);
    let lines = fourier(signal);
    let scale = 2.0 / (0..n).map(weight).sum::<f64>();
    Ok(Spectrum {
        resolution: TAU / (length as f64 * period),
        amplitude: lines.iter().map(|line| scale * line.norm()).collect(),
    })
}

fn check(values: &[f64], period: f64) -> Result<(), SignalError> {
    let found = values.len();
    if found < 4 {
        return Err(SignalError::TooFew {
            what: "spectrum",
            found,
            needed: 4,
        });
    }
    if let Some(index) = values.iter().position(|x| !x.is_finite()) {
        return Err(SignalError::NotFinite {
            what: "spectrum",
            index,
            value: values[index],
        });
    }
    if !(period.is_finite() && period > 0.0) {
        return Err(SignalError::NotFinite {
            what: "sampling period",
            index: 0,
            value: period,
        });
    }
    Ok(())
}

impl Spectrum {
    /// The highest local maximum between two angular frequencies (rad/s), placed between the lines
    /// by the parabola through the logarithms of the three highest.
    ///
    /// `None` where the range holds no local maximum.
    pub fn peak(&self, from: f64, to: f64) -> Option<Peak> {
        let a = &self.amplitude;
        let first = ((from / self.resolution).ceil().max(1.0)) as usize;
        let last = ((to / self.resolution) as usize).min(a.len().checked_sub(2)?);
        let top = (first..=last)
            .filter(|&k| a[k] > 0.0 && a[k] >= a[k - 1] && a[k] >= a[k + 1])
            .max_by(|&i, &j| a[i].total_cmp(&a[j]))?;
        let [l, c, r] = [a[top - 1], a[top], a[top + 1]].map(|x| x.max(f64::MIN_POSITIVE).ln());
        let curvature = l - 2.0 * c + r;
        let shift = if curvature < 0.0 {
            0.5 * (l - r) / curvature
        } else {
            0.0
        };
        Some(Peak {
            frequency: (top as f64 + shift) * self.resolution,
            amplitude: (c - 0.25 * (l - r) * shift).exp(),
        })
    }
}

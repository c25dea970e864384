//! The Cramer-Rao bound: what no unbiased estimator can better.

use quell_shapers::Mode;

use super::likelihood::{Folding, Priors, Track, Window, fit};
use super::{Sample, Settings};

/// Smallest standard deviations of an unbiased estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Of `omega_n`, rad/s.
    pub natural_frequency_std: f64,
    /// Of `xi`.
    pub damping_ratio_std: f64,
}

/// The bound for noise-free samples of a mode, under white noise of `noise_std`.
///
/// The Fisher information of `omega_n`, `xi` and the nuisances that the settings leave free
/// (standard deviations of zero make them known), the free initial state among them. `None` where
/// the samples do not determine the mode.
///
/// Source: S. M. Kay, Fundamentals of Statistical Signal Processing: Estimation Theory (1993), ch. 3.
pub fn cramer_rao(
    samples: &[Sample],
    mode: Mode,
    noise_std: f64,
    settings: &Settings,
) -> Option<Bound> {
    let w = mode.natural_frequency();
    let precision = |std: f64| if std > 0.0 { (std * std).recip() } else { 1e30 };
    let priors = Priors {
        mean: [w.ln(), mode.damping_ratio()],
        precision: [
            0.0,
            0.0,
            0.0,
            0.0,
            precision(settings.offset_std.unwrap_or(noise_std)),
            w * w,
            precision(settings.scale_std),
            precision(settings.gain_std),
        ],
    };
    let variance = noise_std * noise_std;
    let folding = Folding {
        memory: settings.memory,
        priors,
        variance,
    };
    let mut track = Track::new(mode, settings.sample_time);
    let mut window = Window::with_capacity(samples.len());
    for &sample in samples {
        window.push(sample);
        track.absorb(&window, &folding);
    }
    let fit = fit(&track, &priors, variance)?;
    Some(Bound {
        natural_frequency_std: fit.variances[0].sqrt() * noise_std * w,
        damping_ratio_std: fit.variances[1].sqrt() * noise_std,
    })
}

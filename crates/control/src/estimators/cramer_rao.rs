//! The Cramer-Rao bound: the least variance of an unbiased estimator.

use quell_shapers::Mode;

use super::likelihood::{Folding, Priors, Track, Window, fit, inverse_square};
use super::two_mode_likelihood::{Pair, PairPriors, fit_pair};
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
    let priors = Priors {
        mean: [w.ln(), mode.damping_ratio()],
        precision: [
            0.0,
            0.0,
            0.0,
            0.0,
            inverse_square(settings.offset_std.unwrap_or(noise_std)),
            w * w,
            inverse_square(settings.scale_std),
            inverse_square(settings.gain_std),
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

/// The bound for noise-free samples of two modes, as [`cramer_rao`]; an infinite `memory` is assumed.
///
/// `None` where the samples do not determine the modes.
///
/// Source: as [`cramer_rao`].
pub fn two_mode_cramer_rao(
    samples: &[Sample],
    modes: [Mode; 2],
    noise_std: f64,
    settings: &Settings,
) -> Option<[Bound; 2]> {
    let priors = PairPriors::of_known_noise(settings, modes, noise_std);
    let pair = Pair::along(samples, modes, settings.sample_time, |_| {});
    let fit = fit_pair(&pair, &priors, noise_std * noise_std, &[0.0; 4])?;
    Some([0, 1].map(|m| Bound {
        natural_frequency_std: fit.covariance[2 * m][2 * m].sqrt()
            * noise_std
            * modes[m].natural_frequency(),
        damping_ratio_std: fit.covariance[2 * m + 1][2 * m + 1].sqrt() * noise_std,
    }))
}

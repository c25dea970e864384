//! Identification of a recording: every estimator on-line over it, and the off-line references on
//! the same stretches.
//!
//! [`identify`] is a pure function of an aligned series; [`prepare`] makes one from a recording.

mod amplitude;
mod nominal_model;
mod prepare;
mod run;
mod stretches;

pub use amplitude::{AmplitudeDependence, CycleDamping};
pub use nominal_model::{ModelError, NominalModel};
pub use prepare::{IdentificationError, Series, prepare};
pub use run::{OffLine, OnLine, Run};
pub use stretches::Stretch;

use quell_shapers::Mode;

use crate::estimators::offline::{BatchFit, amplitude_spectrum, batch_fit};
use crate::estimators::{ESTIMATORS, Sample, Settings};

/// What is known before the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prior {
    /// The mode that the engineer believes in.
    pub belief: Option<Mode>,
    /// Whether the deformation's scale is open: measured by a sensor of its own (strain gauge)
    /// rather than as a difference of positions.
    pub scale_is_open: bool,
}

/// What a recording says of the mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The whole recording, the motor side as known input.
    pub whole: Run,
    /// Each free decay on its own.
    pub free_decays: Vec<Run>,
    /// Whether the known input explains the deformation: its batch fit agrees with that of the
    /// free decays. `None` where there is no free decay to hold it against.
    pub known_input_holds: Option<bool>,
    /// Share of the deformation's variance that the batch fit of the whole recording explains.
    pub explained: f64,
    /// How damping follows amplitude over the best free decay.
    pub amplitude_dependence: Option<AmplitudeDependence>,
    /// Index of the free decay with the most to tell.
    pub best_decay: Option<usize>,
}

impl Identification {
    /// The run to quote for an estimator, by index into the table: the whole recording for those
    /// that use the motion where the known input holds, else the best free decay.
    pub fn quoted(&self, estimator: usize) -> Option<&Run> {
        let uses_motion = ESTIMATORS.get(estimator)?.uses_motion;
        match self.best_decay {
            Some(best) if !uses_motion || self.known_input_holds == Some(false) => {
                self.free_decays.get(best)
            }
            _ if uses_motion => Some(&self.whole),
            _ => None,
        }
    }

    /// The run whose off-line references are quoted: the best free decay, else the whole.
    pub fn reference(&self) -> &Run {
        self.best_decay
            .and_then(|best| self.free_decays.get(best))
            .unwrap_or(&self.whole)
    }
}

/// Identifies the mode of an aligned series.
///
/// # Errors
/// [`IdentificationError`] where there are fewer than 32 samples or nothing vibrates.
pub fn identify(samples: &[Sample], prior: Prior) -> Result<Identification, IdentificationError> {
    if samples.len() < 32 {
        return Err(IdentificationError::TooFew {
            found: samples.len(),
            needed: 32,
        });
    }
    let settings = settings(samples, prior)?;
    let resting = stretches::rests(samples, &settings);
    let free_decays: Vec<Run> = resting
        .iter()
        .filter_map(|rest| stretches::free_decay(samples, *rest, &settings))
        .map(|stretch| Run::free_decay(samples, stretch, &settings))
        .collect();
    let (whole, fit) = Run::whole(samples, &settings);
    let best_decay = (0..free_decays.len())
        .filter(|&k| free_decays[k].batch().is_some())
        .max_by(|&a, &b| free_decays[a].energy.total_cmp(&free_decays[b].energy));
    let best = best_decay.map(|k| &free_decays[k]);
    let known_input_holds = best.and_then(|run| agree(fit.as_ref(), run));
    let amplitude_dependence = best.and_then(|run| amplitude::dependence(samples, run));
    let explained = fit.map_or(0.0, |fit| 1.0 - explained_not(samples, &fit));
    Ok(Identification {
        whole,
        free_decays,
        known_input_holds,
        explained,
        amplitude_dependence,
        best_decay,
    })
}

/// Whether the fit with the known input and the free decay's give one frequency: within 3 %, or
/// three of their standard deviations.
fn agree(whole: Option<&BatchFit>, decay: &Run) -> Option<bool> {
    let decay = decay.batch()?;
    let whole = whole?;
    let difference = (whole.mode.natural_frequency() - decay.mode.natural_frequency()).abs();
    let std = whole
        .natural_frequency_std
        .hypot(decay.natural_frequency_std.unwrap_or(0.0));
    Some(difference < (0.03 * decay.mode.natural_frequency()).max(3.0 * std))
}

/// Share of the deformation's variance that a fit leaves.
fn explained_not(samples: &[Sample], fit: &BatchFit) -> f64 {
    let mean = samples.iter().map(|s| s.deformation).sum::<f64>() / samples.len() as f64;
    let total: f64 = samples.iter().map(|s| (s.deformation - mean).powi(2)).sum();
    let left: f64 = fit.residual.iter().map(|r| r * r).sum();
    left / total.max(f64::MIN_POSITIVE)
}

/// Settings for a recording: offset free, the whole of it as window, the range of frequencies
/// around the belief, or around the peak of the spectrum.
fn settings(samples: &[Sample], prior: Prior) -> Result<Settings, IdentificationError> {
    let duration = samples[samples.len() - 1].time - samples[0].time;
    let sample_time = duration / (samples.len() - 1) as f64;
    let base = match prior.belief {
        Some(belief) => Settings::around(belief, sample_time),
        None => Settings::within(frequencies(samples, duration, sample_time)?, sample_time),
    };
    Ok(Settings {
        offset_std: Some(f64::INFINITY),
        scale_std: if prior.scale_is_open {
            1.0
        } else {
            base.scale_std
        },
        window: 2.0 * duration,
        ..base
    })
}

/// A quarter of the spectrum's peak to four times it, within two periods a record and five
/// samples a period.
fn frequencies(
    samples: &[Sample],
    duration: f64,
    sample_time: f64,
) -> Result<(f64, f64), IdentificationError> {
    let tau = core::f64::consts::TAU;
    let (low, high) = (2.0 * tau / duration, tau / (5.0 * sample_time));
    let count = ((high - low) / (0.5 * tau / duration))
        .ceil()
        .clamp(2.0, 2000.0) as usize;
    let grid: Vec<f64> = (0..count)
        .map(|k| low * (high / low).powf(k as f64 / (count - 1) as f64))
        .collect();
    let spectrum = amplitude_spectrum(samples, &grid);
    let peak = (0..count).max_by(|&a, &b| spectrum[a].total_cmp(&spectrum[b]));
    match peak {
        Some(k) if low < high && spectrum[k] > 0.0 => {
            Ok(((0.25 * grid[k]).max(low), (4.0 * grid[k]).min(high)))
        }
        _ => Err(IdentificationError::Still),
    }
}

/// The batch fit of some samples, on the way there the only place that calls it.
fn reference_fit(samples: &[Sample], settings: &Settings, motion: bool) -> Option<BatchFit> {
    batch_fit(samples, settings, motion)
}

#![doc = include_str!("../README.md")]

mod above;
mod amplitude;
mod error;
mod evidence;
mod follows;
mod images;
mod input_noise;
mod motor_side;
mod nominal_model;
pub mod output_only;
mod prepare;
pub mod printer;
mod recommended;
mod response;
mod run;
mod scatter;
pub mod stop;
mod stretches;
mod told_mode;
mod whitener;
mod whole_fit;

pub use amplitude::{AmplitudeDependence, CycleDamping};
pub use error::IdentificationError;
pub use images::images;
pub use motor_side::{motor_side, rests};
pub use nominal_model::NominalModel;
pub use prepare::{Series, prepare};
pub use quell_model::ModelError;
pub use quell_model::NO_RESONANCE;
pub use recommended::{Recommended, Why};
pub use response::Searched;
pub use run::{OffLine, OnLine, Run};
pub use stretches::Stretch;
pub use told_mode::ToldMode;

use evidence::Evidence;
use input_noise::White;
use run::Input;
use stop::{Stop, check};
use stretches::FreeDecay;

use core::f64::consts::TAU;

use quell_shapers::Mode;

use quell_control::estimators::offline::{BatchFit, batch_fit, telling};
use quell_control::estimators::{ESTIMATORS, Estimate, Sample, Settings};

/// The settings, known before the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prior {
    /// The mode that the engineer believes in; without it a first batch fit takes its place.
    pub belief: Option<Mode>,
    /// Whether the deformation's scale is unknown: it is measured by a sensor of its own (strain gauge) rather
    /// than as a difference of positions.
    pub scale_is_open: bool,
    /// Range of the deformation that the rounding of the sensors alone makes ([`Series::rounding`]).
    pub rounding: f64,
}

/// The mode in a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The whole recording, the motor side as known input.
    pub whole: Run,
    /// Each free decay on its own.
    pub free_decays: Vec<Run>,
    /// Whether the known input explains the deformation: its batch fit agrees with that of the free decays.
    /// `None` where there is no free decay for comparison.
    pub known_input_holds: Option<bool>,
    /// Share of the deformation's variance that the batch fit of the whole recording explains, over the samples
    /// of that fit.
    pub explained: f64,
    /// How long the simulated vibration may rely on the known input, s; infinite where it may to the end.
    pub memory: f64,
    /// Damping over amplitude in the best free decay.
    pub amplitude_dependence: Option<AmplitudeDependence>,
    /// Index of the free decay with the most information.
    pub best_decay: Option<usize>,
    /// Rests of the motor side after a motion.
    pub rests: usize,
    /// How many of them were searched for a free decay: all except in a long recording.
    pub rests_looked_at: usize,
    /// The frequencies among which the mode was looked for.
    pub searched: Searched,
}

impl Identification {
    /// Whether the recording is so long that the mode was searched in a part of it ([`Run::shown`]), and then
    /// fitted to the whole.
    pub fn is_long(&self) -> bool {
        self.whole.shown != self.whole.stretch
    }

    /// Whether the batch fit is of that part alone, because the fit of the whole left the range of frequencies.
    pub fn is_fit_of_part(&self) -> bool {
        self.whole.fitted != self.whole.stretch
    }

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

    /// The two modes of the first estimator that found two, from its quoted run.
    pub fn two_modes(&self) -> Option<(Estimate, Estimate)> {
        ESTIMATORS.iter().enumerate().find_map(|(index, line)| {
            let result = self.quoted(index)?.estimator(line.name)?;
            result.estimate.zip(result.further)
        })
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
/// [`IdentificationError`] where there are fewer than 32 samples, nothing varies, no mode stands out of the noise, or what does
/// is no resonance.
pub fn identify(samples: &[Sample], prior: Prior) -> Result<Identification, IdentificationError> {
    identify_until(samples, prior, &stop::never)
}

/// [`identify`], unless it is stopped.
///
/// # Errors
/// As [`identify`], and [`IdentificationError::Stopped`].
pub fn identify_until(
    samples: &[Sample],
    prior: Prior,
    stop: Stop,
) -> Result<Identification, IdentificationError> {
    if samples.len() < 32 {
        return Err(IdentificationError::TooFew {
            found: samples.len(),
            needed: 32,
        });
    }
    let searched = searched(samples, prior)?;
    let found = search(samples, prior, (searched, stop));
    check(stop)?;
    match prior.belief {
        Some(_) => found,
        None => above::unless_above(found, samples, &searched, stop),
    }
}

/// The mode among the frequencies that are searched.
fn search(
    samples: &[Sample],
    prior: Prior,
    (searched, stop): (Searched, Stop),
) -> Result<Identification, IdentificationError> {
    let part = telling(samples);
    check(stop)?;
    let settings = settings(samples, part, (prior, &searched))?;
    let rests = stretches::rests(samples, &settings);
    let looked_at = stretches::evenly(samples, &rests);
    let decays: Vec<FreeDecay> = looked_at
        .iter()
        .take_while(|_| !stop())
        .filter_map(|rest| stretches::free_decay(samples, *rest, &settings))
        .collect();
    check(stop)?;
    let (settings, fit) = whole_fit::trusted_memory(part, settings);
    check(stop)?;
    let (fitted, fit) = whole_fit::follow(samples, part, &settings, fit);
    check(stop)?;
    let white = fit
        .as_ref()
        .and_then(|fit| White::of(fitted, fit, &settings));
    check(stop)?;
    let louder = match (&fit, &white) {
        (Some(fit), None) => input_noise::louder(fitted, fit, &settings),
        _ => 1.0,
    };
    let best_fit = white.as_ref().map(|white| &white.fit).or(fit.as_ref());
    let (free_decays, known_input_holds) =
        free_decays(samples, &decays, (&settings, stop), best_fit);
    check(stop)?;
    let best_decay = strongest(&free_decays);
    if best_decay.is_none() {
        let evidence = Evidence::of_all(fitted, fit.as_ref(), settings.memory);
        evidence.strong().map_err(|error| match prior.belief {
            Some(belief) => searched.not_near(belief),
            None => error.among(searched.hertz()),
        })?;
        if let Some(fit) = &fit {
            evidence.no_artefact(fitted, fit, prior.rounding)?;
        }
    }
    let best = best_decay.map(|k| &free_decays[k]);
    let amplitude_dependence = best.and_then(|run| amplitude::dependence(samples, run));
    let explained = fit
        .as_ref()
        .map_or(0.0, |fit| 1.0 - explained_not(fitted, fit));
    let found = Identification {
        whole: Run::whole(
            samples,
            part,
            &settings,
            (fitted, fit.as_ref(), white.as_ref()),
        )
        .widened(louder),
        free_decays,
        known_input_holds,
        explained,
        memory: settings.memory,
        amplitude_dependence,
        best_decay,
        rests: rests.len(),
        rests_looked_at: looked_at.len(),
        searched,
    };
    found.vibrates()?;
    Ok(found)
}

/// The runs of all free decays, and whether the known input holds. If it does, the settling of the motor side
/// during a decay is a known input, too; else the motor side counts as standing still.
fn free_decays(
    samples: &[Sample],
    decays: &[FreeDecay],
    (settings, stop): (&Settings, Stop),
    whole: Option<&BatchFit>,
) -> (Vec<Run>, Option<bool>) {
    let fits = |input: Input| -> Vec<Option<BatchFit>> {
        let tells = |decay: &FreeDecay, fit: &BatchFit| {
            Evidence::of_decay(decay.stretch.of(samples), fit).tells()
        };
        let fit = |decay| run::fit(samples, decay, settings, input).filter(|fit| tells(decay, fit));
        decays.iter().take_while(|_| !stop()).map(fit).collect()
    };
    let energy = |k: usize, fit| run::energy(decays[k].stretch.of(samples), Some(fit));
    let mut found = fits(Input::Still);
    let told = found.iter().enumerate();
    let best = told
        .filter_map(|(k, fit)| Some((fit.as_ref()?, energy(k, fit.as_ref()?))))
        .max_by(|a, b| a.1.total_cmp(&b.1));
    let known_input_holds = best.and_then(|(decay, _)| Some(agree(whole?, decay)));
    let mut input = Input::Still;
    if known_input_holds == Some(true) {
        input = Input::Known;
        found = fits(input);
    }
    let pairs = decays.iter().zip(&found);
    let run = |(decay, fit): (_, &Option<BatchFit>)| {
        Some(Run::free_decay(
            samples,
            decay,
            settings,
            (input, Some(fit.as_ref()?)),
        ))
    };
    let pairs = pairs.take_while(|_| !stop());
    (pairs.filter_map(run).collect(), known_input_holds)
}

/// The free decay with the largest deformation, of those that a batch fit could follow.
fn strongest(decays: &[Run]) -> Option<usize> {
    (0..decays.len())
        .filter(|&k| decays[k].batch().is_some())
        .max_by(|&a, &b| decays[a].energy.total_cmp(&decays[b].energy))
}

/// Whether the fit with the known input and that of the free decay have the same frequency: within 3 %, or
/// within three of their standard deviations if these are smaller than that.
fn agree(whole: &BatchFit, decay: &BatchFit) -> bool {
    let w = decay.mode.natural_frequency();
    let difference = (whole.mode.natural_frequency() - w).abs();
    let std = whole
        .natural_frequency_std
        .hypot(decay.natural_frequency_std);
    difference < (0.03 * w).max(3.0 * std.min(0.03 * w))
}

/// Share of the deformation's variance that a fit leaves.
fn explained_not(samples: &[Sample], fit: &BatchFit) -> f64 {
    let mean = samples.iter().map(|s| s.deformation).sum::<f64>() / samples.len() as f64;
    let total: f64 = samples.iter().map(|s| (s.deformation - mean).powi(2)).sum();
    let left: f64 = fit.residual.iter().map(|r| r * r).sum();
    left / total.max(f64::MIN_POSITIVE)
}

fn duration(samples: &[Sample]) -> f64 {
    samples[samples.len() - 1].time - samples[0].time
}

/// The frequencies among which the mode is looked for: within an octave of the belief; without one at least two periods in the
/// searched part, and at least five samples in a period.
fn searched(samples: &[Sample], prior: Prior) -> Result<Searched, IdentificationError> {
    let sample_time = duration(samples) / (samples.len() - 1) as f64;
    let (from, to) = match prior.belief {
        Some(belief) => Settings::around(belief, sample_time).frequency_range,
        None => (
            2.0 * TAU / duration(telling(samples)),
            TAU / (5.0 * sample_time),
        ),
    };
    match prior.belief.is_none() && from >= to {
        true => Err(IdentificationError::Still),
        false => Ok(Searched {
            from,
            to,
            sample_time,
        }),
    }
}

/// Settings for a recording: offset free, and the whole of it as window.
fn settings(
    samples: &[Sample],
    part: &[Sample],
    (prior, searched): (Prior, &Searched),
) -> Result<Settings, IdentificationError> {
    let common = |base: Settings| Settings {
        offset_std: Some(f64::INFINITY),
        scale_std: if prior.scale_is_open {
            1.0
        } else {
            base.scale_std
        },
        window: 2.0 * duration(samples),
        ..base
    };
    if let Some(belief) = prior.belief {
        return Ok(common(Settings::around(belief, searched.sample_time)));
    }
    let range = (searched.from, searched.to);
    let wide = common(Settings::within(range, searched.sample_time));
    first_look(samples, part, wide)
}

/// The first mode without a belief, from batch fits over a wide range: of the longest rest and of the
/// recording, or of parts of these. The rest's mode is used, and both are within the range of the settings.
fn first_look(
    samples: &[Sample],
    part: &[Sample],
    wide: Settings,
) -> Result<Settings, IdentificationError> {
    let mode = |samples: &[Sample], motion| Some(batch_fit(samples, &wide, motion)?.mode);
    let whole = mode(part, true);
    let rest = stretches::rests(samples, &wide)
        .into_iter()
        .max_by(|a, b| (a.until - a.from).total_cmp(&(b.until - b.from)))
        .and_then(|rest| mode(telling(rest.of(samples)), false));
    let Some(belief) = rest.or(whole) else {
        let (from, to) = wide.frequency_range;
        Evidence::of_all(samples, None, wide.memory)
            .strong()
            .map_err(|error| error.among([from / TAU, to / TAU]))?;
        return Err(IdentificationError::Still);
    };
    let other = whole.unwrap_or(belief).natural_frequency();
    let w = belief.natural_frequency();
    let around = Settings::around(belief, wide.sample_time);
    Ok(Settings {
        belief: around.belief,
        frequency_range: (0.5 * w.min(other), 2.0 * w.max(other)),
        ..wide
    })
}

//! A mode above the frequencies that the motor side's motion can tell: free decays in its rests show one up to half the rate.

use super::output_only::{Excitation, Vibration, are_even, output_only_within};
use super::stop::Stop;
use super::{Identification, IdentificationError, Searched, stretches};
use core::f64::consts::PI;
use quell_control::estimators::{Sample, Settings};
use quell_recording::Role;
use quell_shapers::Mode;

/// The share of the range from which on a mode is at its end.
const END: f64 = 0.9;
/// Largest relative difference of two frequencies of one mode, as of a free decay and the motion.
const ONE: f64 = 0.03;

/// A finding, unless it has no free decay and the motor side's rests ring at another frequency, at the end of what was searched
/// or above. What is told without that would be what is left of it: a tip at rest, or a mode that hardly rings.
///
/// # Errors
/// [`IdentificationError::Above`] with that mode; else the finding's own.
pub(super) fn unless_above(
    found: Result<Identification, IdentificationError>,
    samples: &[Sample],
    searched: &Searched,
    stop: Stop,
) -> Result<Identification, IdentificationError> {
    let may_be = match &found {
        Ok(found) => found.best_decay.is_none(),
        Err(error) => error.is_no_mode(),
    };
    if !may_be {
        return found;
    }
    let Some(mode) = above(samples, searched, stop) else {
        return found;
    };
    let hertz = mode.hertz();
    let is_found = |own: &Identification| {
        let best = own.recommended();
        best.is_some_and(|best| (best.mode.mode.hertz() / hertz - 1.0).abs() < ONE)
    };
    match found {
        Ok(found) if is_found(&found) => Ok(found),
        _ => Err(IdentificationError::Above {
            hertz,
            searched: searched.hertz(),
            rate: 1.0 / searched.sample_time,
        }),
    }
}

/// The strongest mode of the rests, if it is at the end of the range or above.
fn above(samples: &[Sample], searched: &Searched, stop: Stop) -> Option<Mode> {
    let (first, period) = (samples.first()?.time, searched.sample_time);
    if !are_even(samples.iter().map(|sample| sample.time), [first, period]) {
        return None;
    }
    let settings = Settings::within((END * searched.to, PI / period), period);
    let rests = stretches::rests(samples, &settings);
    let rests: Vec<[f64; 2]> = rests.iter().map(|rest| [rest.from, rest.until]).collect();
    let vibration = Vibration {
        role: Role::Deformation,
        unit: String::new(),
        start: first,
        rate: 1.0 / period,
        axes: vec![samples.iter().map(|sample| sample.deformation).collect()],
        used: 1.0,
        clipped: Vec::new(),
    };
    if rests.is_empty() {
        return None;
    }
    let found = output_only_within(&vibration, &rests, stop).ok()?;
    let mode = found.modes.first()?.known.mode;
    let is_above = mode.natural_frequency() > END * searched.to;
    (is_above && found.excitation == Excitation::Decay).then_some(mode)
}

//! A mode above the frequencies that the motor side's motion can tell: free decays in its rests show one up to half the rate.

use super::output_only::{Excitation, Vibration, output_only_within};
use super::recommended::known;
use super::stop::Stop;
use super::{Identification, IdentificationError, Run, Searched, Why, stretches};
use core::f64::consts::PI;
use quell_control::estimators::{Sample, Settings};
use quell_model::NO_RESONANCE;
use quell_recording::{Role, are_even};
use quell_shapers::UncertainMode;

/// Standard deviations within which two estimates of one frequency are: 997 of 1000.
const CERTAIN: f64 = 3.0;

/// A finding, unless the motor side's rests ring at another frequency that makes it doubtful:
///
/// - no free decay confirms the finding, or there is none, and the rests ring at the end of what was searched or above;
/// - the finding is another mode than that of its own free decays, or lies outside of what was searched. Then the motion does not
///   explain how the rests ring, wherever that is: a mode above half the rate has its image there, as after a move that is done
///   within one sample.
///
/// What is told without that would be what is left of the mode: a tip at rest, or a response that hardly rings.
///
/// # Errors
/// [`IdentificationError::Above`] with that mode; else the finding's own.
pub(super) fn unless_above(
    found: Result<Identification, IdentificationError>,
    samples: &[Sample],
    searched: &Searched,
    stop: Stop,
) -> Result<Identification, IdentificationError> {
    let (may_be, anywhere) = match &found {
        Ok(found) => (!found.is_confirmed(), found.best_decay.is_some()),
        Err(error) => (error.is_no_mode(), error.is_out_of_range()),
    };
    if !may_be {
        return found;
    }
    let Some(rests) = ringing(samples, searched, stop) else {
        return found;
    };
    let is_at_the_end = rests.mode.natural_frequency() + unsure(&rests) > searched.to;
    let is_found = |own: &Identification| {
        let best = own.recommended();
        best.is_some_and(|best| best.modes().any(|mode| are_one(&mode, &rests)))
    };
    match found {
        Ok(found) if is_found(&found) => Ok(found),
        found if !(anywhere || is_at_the_end) => found,
        _ => Err(IdentificationError::Above {
            hertz: rests.mode.hertz(),
            searched: searched.hertz(),
            rate: 1.0 / searched.sample_time,
        }),
    }
}

impl Identification {
    /// Whether its strongest free decay has the mode that is recommended, or is what it is recommended from.
    fn is_confirmed(&self) -> bool {
        let decay = self.best_decay.and_then(|best| self.free_decays.get(best));
        let decay = decay.and_then(Run::batch).and_then(known);
        let best = self.recommended();
        let both = decay.zip(best);
        both.is_some_and(|(decay, best)| best.why != Why::Motion || are_one(&best.mode, &decay))
    }
}

/// Whether two estimates may be of one mode: nearer than its half-power bandwidth on either side, within which two resonances
/// have one peak, and than their standard deviations allow.
fn are_one(own: &UncertainMode, ringing: &UncertainMode) -> bool {
    let apart = own.mode.natural_frequency() - ringing.mode.natural_frequency();
    // However unsure an estimate is, it is of no mode that is beyond the widest of half-power bandwidths.
    let deviation = own
        .natural_frequency_std
        .min(ringing.mode.natural_frequency() * NO_RESONANCE);
    apart.abs() < unsure(ringing).hypot(CERTAIN * deviation)
}

/// Half the half-power bandwidth, `xi w_n`, with the deviations of the frequency; rad/s.
fn unsure(own: &UncertainMode) -> f64 {
    let half = own.mode.damping_ratio() * own.mode.natural_frequency();
    half.hypot(CERTAIN * own.natural_frequency_std)
}

/// The strongest mode of the rests, if these are free decays.
fn ringing(samples: &[Sample], searched: &Searched, stop: Stop) -> Option<UncertainMode> {
    let (first, period) = (samples.first()?.time, searched.sample_time);
    if !are_even(samples.iter().map(|sample| sample.time), [first, period]) {
        return None;
    }
    let settings = Settings::within((searched.to, PI / period), period);
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
    let known = found.modes.first()?.known;
    (known.mode.damping_ratio() < NO_RESONANCE && found.excitation == Excitation::Decay)
        .then_some(known)
}

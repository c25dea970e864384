//! Output-only modal identification: modes from an accelerometer, or any vibrating channel, without a known
//! input.
//!
//! A free decay is fitted in time, as damped sinusoids by maximum likelihood. The response to a sweep or of a
//! machine at work is fitted in frequency, as a sum of resonances by Whittle's likelihood. The Bayesian
//! information criterion decides the number of modes.

mod course;
mod criterion;
mod damped;
mod decay;
mod density;
mod distortion;
mod driven_on;
mod even;
mod events;
mod free;
mod least_squares;
mod level;
mod oscillation;
mod resonances;
mod response;
mod told;

pub use density::{Density, Taken, density};
pub use even::{Vibration, vibration};
pub use told::{LeftOut, Reason};

use super::IdentificationError;
use super::stop::{Stop, check, never};
use free::Seen;
use quell_shapers::UncertainMode;

/// How the modes were excited, and so how they were fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Excitation {
    /// A free decay, or several: taps, stops.
    Decay,
    /// A sine or pulses whose frequency goes from one to another, Hz.
    Sweep {
        /// From.
        from: f64,
        /// To.
        to: f64,
    },
    /// A machine at work, or noise: the excitation is taken as broad.
    Work,
}

/// Fewest samples of a vibration.
const FEWEST: usize = 32;

/// A mode and its properties in this recording.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundMode {
    /// The mode with its standard deviations; of one whose frequency depends on the amplitude, at small amplitude.
    pub known: UncertainMode,
    /// Share of the largest mode's amplitude after an impulse.
    pub share: f64,
    /// Relative difference of the frequency at the greatest amplitude; 0 if it does not depend on the
    /// amplitude.
    pub frequency_shift: f64,
    /// Standard deviation of that.
    pub frequency_shift_std: f64,
    /// Difference of the damping ratio at the greatest amplitude.
    pub damping_shift: f64,
}

/// The modes of a vibration.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputOnly {
    /// How they were excited.
    pub excitation: Excitation,
    /// The modes, the strongest first.
    pub modes: Vec<FoundMode>,
    /// What was fitted and is no mode of its own.
    pub left_out: Vec<LeftOut>,
    /// Stretches that were fitted, s.
    pub stretches: Vec<[f64; 2]>,
    /// Share of the variance in these that the modes explain (of a sweep or work: of the logarithm of the spectrum).
    pub explained: f64,
    /// Fall of the criterion by the modes, and the value that is strong evidence.
    pub evidence: [f64; 2],
}

/// The modes of a vibration.
///
/// # Errors
/// [`IdentificationError`] where there are too few samples, nothing varies, or no mode stands out of the noise.
pub fn output_only(vibration: &Vibration) -> Result<OutputOnly, IdentificationError> {
    output_only_until(vibration, &never)
}

/// [`output_only`], unless it is stopped.
///
/// # Errors
/// As [`output_only`], and [`IdentificationError::Stopped`].
pub fn output_only_until(
    vibration: &Vibration,
    stop: Stop,
) -> Result<OutputOnly, IdentificationError> {
    output_only_within(vibration, &[], stop)
}

/// [`output_only_until`], where what drives the machine is known to rest in these spans (s) and to move outside of them: a free
/// decay lies within one. Without any, nothing is known.
///
/// # Errors
/// As [`output_only_until`].
pub fn output_only_within(
    vibration: &Vibration,
    rests: &[[f64; 2]],
    stop: Stop,
) -> Result<OutputOnly, IdentificationError> {
    let found = look(vibration, rests, stop);
    // If it was stopped, a skipped part is no result.
    check(stop).and(found)
}

fn look(
    vibration: &Vibration,
    rests: &[[f64; 2]],
    stop: Stop,
) -> Result<OutputOnly, IdentificationError> {
    let samples = vibration.axes.first().map_or(0, Vec::len);
    if samples < FEWEST {
        return Err(IdentificationError::TooFew {
            found: samples,
            needed: FEWEST,
        });
    }
    if vibration.is_still() {
        return Err(IdentificationError::Still);
    }
    let sweep = events::sweep(vibration);
    if let Some(found) = decays(vibration, (rests, sweep.is_some()), stop) {
        return Ok(found);
    }
    let found = resonances::modes(vibration, sweep, stop);
    let shows_one = found.as_ref().is_ok_and(|found| !found.modes.is_empty());
    if !shows_one && sweep.is_none() && rests.is_empty() {
        let all = [events::to_the_end(vibration)];
        if let Some(found) = decay::modes(vibration, (&all, Seen::After), stop) {
            return Ok(found);
        }
    }
    let found = found?;
    match found.modes.is_empty() {
        false => Ok(found),
        true if found.evidence[0] >= found.evidence[1] => Err(IdentificationError::OnlyLines),
        true => Err(IdentificationError::NotExcited {
            found: found.evidence[0],
            needed: found.evidence[1],
            samples,
            searched: None,
        }),
    }
}

/// The modes of free decays in rests, of those that fall far, or of the first that shows in the noise of a rest.
fn decays(
    vibration: &Vibration,
    (rests, is_swept): (&[[f64; 2]], bool),
    stop: Stop,
) -> Option<OutputOnly> {
    let modes = |some: &[[usize; 2]], seen: Seen| decay::modes(vibration, (some, seen), stop);
    let lengths = match is_swept {
        true => Vec::new(),
        false => events::lengths(vibration),
    };
    let falls = |length: usize| {
        let some = events::decays(vibration, length);
        modes(&events::at_rest(vibration, some, rests), Seen::Before)
    };
    let within = events::within(vibration, rests);
    let faint = |rest: &[usize; 2]| modes(std::slice::from_ref(rest), Seen::Faint);
    modes(&within, Seen::Before)
        .or_else(|| lengths.into_iter().find_map(falls))
        .or_else(|| within.iter().filter(|_| !is_swept).find_map(faint))
}

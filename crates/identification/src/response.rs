//! What a found mode can be: a resonance or not, of the link alone or of servo and link; and which frequencies were
//! looked at.

use super::{Identification, IdentificationError, Recommended, Series};
use quell_model::NO_RESONANCE;
use quell_recording::Role;
use quell_shapers::{Mode, UncertainMode};

/// Half of a 95 % interval, in standard deviations.
const OF_95: f64 = 1.96;

/// The frequencies among which a mode was looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Searched {
    /// Lowest, rad/s: two periods in the searched part, or half the believed frequency.
    pub from: f64,
    /// Highest, rad/s: five samples in a period, or twice the believed frequency.
    pub to: f64,
    /// Time between two samples, on average, s.
    pub sample_time: f64,
}

impl Searched {
    /// Both ends, Hz.
    pub(super) fn hertz(&self) -> [f64; 2] {
        [self.from, self.to].map(|omega| omega / core::f64::consts::TAU)
    }

    /// The refusal where no mode was found about a belief.
    pub(super) fn not_near(&self, belief: Mode) -> IdentificationError {
        IdentificationError::NotNear {
            belief: belief.hertz(),
            belief_damping: belief.damping_ratio(),
            searched: self.hertz(),
        }
    }
}

impl Recommended {
    /// Lower end of the 95 % interval of the damping ratio, not below 0.
    pub fn least_damping(&self) -> f64 {
        let least = self.mode.mode.damping_ratio() - OF_95 * self.mode.damping_ratio_std;
        least.max(0.0)
    }

    /// Whether the response may be a resonance: the 95 % interval of its damping ratio begins below [`NO_RESONANCE`].
    pub fn may_be_resonance(&self) -> bool {
        self.least_damping() < NO_RESONANCE
    }
}

impl Identification {
    /// Refuses a recommended mode for which a shaper is of no use: outside of what was searched, or no resonance.
    ///
    /// # Errors
    /// [`IdentificationError::OutOfRange`] and [`IdentificationError::NoResonance`].
    pub(super) fn vibrates(&self) -> Result<(), IdentificationError> {
        let Some(best) = self.recommended() else {
            return Ok(());
        };
        let Searched { from, to, .. } = self.searched;
        let is_outside = |own: &UncertainMode| !(from..=to).contains(&own.mode.natural_frequency());
        if let Some(own) = best.modes().find(is_outside) {
            return Err(IdentificationError::OutOfRange {
                hertz: own.mode.hertz(),
                searched: self.searched.hertz(),
            });
        }
        match best.may_be_resonance() {
            true => Ok(()),
            false => Err(IdentificationError::NoResonance {
                hertz: best.mode.mode.hertz(),
                least_damping: best.least_damping(),
                of_servo: false,
            }),
        }
    }
}

impl Series {
    /// Whether a servo is part of what was identified: the command stands for the motor side.
    pub fn includes_servo(&self) -> bool {
        self.motor_side == Role::CommandPosition
    }
}

impl Identification {
    /// The highest frequency that the samples can show, rad/s: half their rate (Nyquist).
    pub fn nyquist(&self) -> f64 {
        core::f64::consts::PI / self.searched.sample_time
    }
}

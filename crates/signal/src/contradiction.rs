//! What motor side and link of a recording contradict each other in.

use super::{Direction, StaticRatio};
use quell_recording::{Recording, Role};

/// A mistake of sensors or of a manifest that no physics of a joint explains.
#[derive(Clone, Debug, PartialEq)]
pub struct Contradiction {
    /// The motor side that the link contradicts.
    pub motor_side: Role,
    /// The mistake and what to write instead, a sentence without a full stop.
    pub words: String,
}

impl Contradiction {
    /// The first one of: a link that moves another way or another distance than its motor side ([`StaticRatio`]), and a motor
    /// side that follows its link ([`Direction`]). A gear between the two makes the second question meaningless.
    pub fn of(recording: &Recording) -> Option<Self> {
        let ratio = StaticRatio::of(recording);
        let ratio = ratio.and_then(|own| Some((own.motor_side, own.contradiction()?)));
        let direction = || {
            Some((
                Role::MotorPosition,
                Direction::of(recording)?.contradiction()?,
            ))
        };
        let (motor_side, words) = ratio.or_else(direction)?;
        Some(Self { motor_side, words })
    }
}

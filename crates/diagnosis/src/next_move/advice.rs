//! Advice for explanations that no motion separates: a change of payload, mounting or sensor.

use crate::point::EffectAt;
use quell_model::effects::{LIKENESSES, Likeness, Place};

/// Advice that separates explanations with these effects: that of the first likeness that they share, else that
/// of the places at which only one has an effect.
pub fn advice(one: &[EffectAt], other: &[EffectAt]) -> &'static str {
    let has =
        |side: &[EffectAt], likeness: Likeness| side.iter().any(|own| own.0.is_alike(likeness));
    let mut shared = LIKENESSES.iter();
    let shared = shared.find(|&&likeness| has(one, likeness) && has(other, likeness));
    let at = |side: &[EffectAt], place: Place| side.iter().any(|effect| effect.1 == place);
    let only = |place: Place| at(one, place) != at(other, place);
    match shared {
        Some(likeness) => likeness.remedy(),
        None if only(Place::Sensor) => {
            "a second sensor beside the first: both show what the machine does, only one what it adds"
        }
        None if only(Place::Base) => "a sensor on the base",
        None if only(Place::Drive) => "the current of the motor, or a sensor at the drive",
        None => "another payload, or a sensor of less noise",
    }
}

//! Links that friction may hold at the start.

use quell_model::Term;
use quell_model::chain::{Linear, MotorSide};
use quell_model::effects::{Law, Place};

/// Whether friction may hold a link at any deformation within a band: on a prescribed motor side, against it or
/// against the ground.
pub fn may_be_held(linear: &Linear, terms: &[Term]) -> bool {
    let sticks = |term: &Term| match (term.effect.law)(&term.values) {
        Law::Friction(friction) => friction.transition_velocity == 0.0,
        _ => false,
    };
    let prescribed = linear.motor == MotorSide::Prescribed && linear.link.is_some();
    let mut at_link = terms.iter().filter(|term| term.place != Place::Drive);
    prescribed && at_link.any(sticks)
}

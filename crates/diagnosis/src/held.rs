//! Links that friction may hold at the start.

use quell_model::Term;
use quell_model::chain::{Linear, MotorSide};
use quell_model::effects::{Friction, Law, Place};

/// Whether friction may hold a link at any deformation within a band: on a prescribed motor side, against it or
/// against the ground.
pub fn may_be_held(linear: &Linear, terms: &[Term]) -> bool {
    holding(linear, terms).next().is_some()
}

/// Half the width of that band at a position of the motor side: what the friction at rest deforms.
pub fn held_within(linear: &Linear, terms: &[Term], position: f64) -> f64 {
    let level = |own: Friction| [1.0, -1.0].map(|sign| own.level(sign, position, 0.0));
    let most = holding(linear, terms).map(|own| level(own).into_iter().fold(0.0, f64::max));
    most.sum::<f64>() * linear.unit_force / linear.stiffness
}

/// The frictions that stick between a link and a prescribed motor side or the ground.
fn holding(linear: &Linear, terms: &[Term]) -> impl Iterator<Item = Friction> {
    let prescribed = linear.motor == MotorSide::Prescribed && linear.link.is_some();
    let at_link = terms
        .iter()
        .filter(move |term| prescribed && term.place != Place::Drive);
    at_link.filter_map(|term| match (term.effect.law)(&term.values) {
        Law::Friction(own) if own.transition_velocity == 0.0 => Some(own),
        _ => None,
    })
}

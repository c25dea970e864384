//! A force of any shape over the position.

use super::learned::{FINER, PARAMETERS, ordinate, over_position, parameters, spline};
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, Place, Property, Quantity, Slot, Spline,
};

struct OverPosition(Spline);

impl Force for OverPosition {
    fn force(&self, _motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        self.0.stable(x, 0.0)
    }
}

/// A force that depends on the position of the axis: `F = f(x)`.
pub const LEARNED_POSITION_FORCE: Effect = Effect {
    parameters: &parameters::<PARAMETERS>(ORDINATE, Quantity::POSITION),
    properties: &[Property::Slot(Slot::PositionForce), Property::Finer(&FINE)],
    starts: over_position::<PARAMETERS>,
    ..FINE
};

/// The same with finer knots: what a detent or a pocket in a guide does within a small part of the travel.
const FINE: Effect = Effect {
    name: "learned_position_force",
    title: "learned force over position",
    places: &[Place::Drive, Place::Link],
    physics: "A force f(x) resists positive motion at each position x, whatever the speed: weights, springs to \
        ground, cables, a guide that is tight at one end. The curve is learned: a cubic spline through its values \
        at equally spaced positions, of constant slope outside of what was visited, or constant where it would push \
        away from there. What changes faster over the \
        position than the knots lie is cogging. Source: de Boor, A Practical Guide to Splines (1978); Eilers and \
        Marx, Statistical Science 11 (1996).",
    remedy: "Look at the curve, and for what pulls there; add it to the feedforward as a table over the position.",
    law: |p| Law::Force(Box::new(OverPosition(spline(p)))),
    parameters: &parameters::<FINER>(ORDINATE, Quantity::POSITION),
    properties: &[Property::Slot(Slot::PositionForce)],
    starts: over_position::<FINER>,
};

const ORDINATE: Parameter = ordinate(
    Quantity::FORCE,
    |scales| (-20.0 * scales.force, 20.0 * scales.force),
    |scales| 0.05 * scales.force,
);

//! A spring of any shape.

use super::learned::{OverPosition, PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Law, Place, Property, Quantity, Slot};

/// An elastic force of any shape beside that of the model's spring: `F = f(x)`, `x` the deformation.
pub const LEARNED_SPRING: Effect = Effect {
    name: "learned_spring",
    title: "learned spring",
    places: &[Place::Transmission],
    physics: "The spring's force differs from k x by a curve f(x) over the deformation, which is learned: a cubic \
        spline through its values at equally spaced deformations, of constant slope outside of what was visited. \
        Source: de Boor, A Practical Guide to Splines (1978); Eilers and Marx, Statistical Science 11 (1996).",
    remedy: "Look at the curve: it says what the spring does that the model's does not.",
    parameters: &parameters::<PARAMETERS>(
        ordinate(
            Quantity::FORCE,
            |scales| (-5.0 * scales.force, 5.0 * scales.force),
            |scales| 0.05 * scales.force,
        ),
        Quantity::POSITION,
    ),
    properties: &[Property::Slot(Slot::Spring)],
    law: |p| Law::Force(Box::new(OverPosition(spline(p)))),
    starts: |scales| vec![start::<PARAMETERS>(scales.visited_deformation())],
};

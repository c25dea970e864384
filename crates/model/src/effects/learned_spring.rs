//! A spring of any shape.

use super::learned::{FINER, PARAMETERS, ordinate, parameters, spline, start};
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, Place, Property, Quantity, Slot, Spline,
};

struct Spring(Spline);

impl Force for Spring {
    fn force(&self, motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        self.0.stable(x, motion.stiffness)
    }
}

const FORCE: Parameter = ordinate(
    Quantity::FORCE,
    |scales| (-5.0 * scales.force, 5.0 * scales.force),
    |scales| 0.05 * scales.force,
);

/// An elastic force of any shape beside that of the model's spring: `F = f(x)`, `x` the deformation.
pub const LEARNED_SPRING: Effect = Effect {
    parameters: &parameters::<PARAMETERS>(FORCE, Quantity::POSITION),
    properties: &[Property::Slot(Slot::Spring), Property::Finer(&FINE)],
    starts: |scales| vec![start::<PARAMETERS>(scales.visited_deformation())],
    ..FINE
};

/// The same with finer knots, for a spring that is softer about its rest.
const FINE: Effect = Effect {
    name: "learned_spring",
    title: "learned spring",
    places: &[Place::Transmission],
    physics: "The spring's force differs from k x by a curve f(x) over the deformation, which is learned: a cubic \
        spline through its values at equally spaced deformations, of constant slope outside of what was visited; \
        where the spring as a whole would give way there, the curve keeps its last value. Source: de Boor, A Practical Guide to Splines (1978); Eilers and Marx, Statistical Science 11 (1996).",
    remedy: "Look at the curve: it says what the spring does that the model's does not.",
    parameters: &parameters::<FINER>(FORCE, Quantity::POSITION),
    properties: &[Property::Slot(Slot::Spring)],
    law: |p| Law::Force(Box::new(Spring(spline(p)))),
    starts: |scales| vec![start::<FINER>(scales.visited_deformation())],
};

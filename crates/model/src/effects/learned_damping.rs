//! Damping of any shape.

use super::learned::{PARAMETERS, ordinate, parameters, spline, start};
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, Place, Property, Quantity, Slot, Spline,
};

struct Damping(Spline);

impl Force for Damping {
    fn force(&self, motion: &Motion, x: f64, v: f64, _memory: &Memory) -> f64 {
        beside(motion, self.0.not_less(x)) * v
    }
}

/// Damping that depends on the deformation, beside that of the model's damper: `F = c(x) x'`.
pub const LEARNED_DAMPING: Effect = Effect {
    name: "learned_damping",
    title: "learned damping",
    places: &[Place::Transmission],
    physics: "The damper's coefficient differs from c by a curve over the deformation, which is learned: a cubic \
        spline through its values at equally spaced deformations, outside of what was visited of constant slope \
        where it rises, else constant; the whole coefficient is never below 0. Contacts that press harder rub more, so that large vibration dies out faster than small. Source: van der \
        Pol, Philosophical Magazine 2 (1926), for a parabola; de Boor, A Practical Guide to Splines (1978).",
    remedy: "Look at the curve; take the damping at the amplitude that matters.",
    parameters: &parameters::<PARAMETERS>(COEFFICIENT, Quantity::POSITION),
    properties: &[Property::Slot(Slot::Damping)],
    law: |p| Law::Force(Box::new(Damping(spline(p)))),
    starts: |scales| vec![start::<PARAMETERS>(scales.visited_deformation())],
};

/// A coefficient beside that of the model's damper. A negative one reduces that damper, at most to 0.
pub(super) const COEFFICIENT: Parameter = ordinate(
    Quantity::new(1, -1, 1),
    |scales| {
        let unit = scales.force / scales.deformation;
        let own = 2.0 * scales.damping_ratio / scales.natural_frequency * unit;
        (-own, 10.0 * scales.force / scales.deformation_rate)
    },
    |scales| 0.05 * scales.force / scales.deformation_rate,
);

/// A coefficient beside that of the model's damper, which is reduced to 0 at most: a damper never drives.
pub(super) fn beside(motion: &Motion, coefficient: f64) -> f64 {
    coefficient.max(-motion.damping)
}

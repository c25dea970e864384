//! Viscous friction of the drive.

use super::grid::sizes;
use super::{
    Effect, Force, Law, Likeness, Memory, Motion, Parameter, ParameterRole, Place, Property,
    Quantity, Slot,
};

/// A force in proportion to a velocity.
pub(super) struct Viscous {
    pub coefficient: f64,
}

impl Force for Viscous {
    fn force(&self, _motion: &Motion, _x: f64, v: f64, _memory: &Memory) -> f64 {
        self.coefficient * v
    }
}

/// A force against the motor side in proportion to its speed: `F = c v`.
pub const VISCOUS_FRICTION: Effect = Effect {
    name: "viscous_friction",
    title: "viscous friction",
    places: &[Place::Drive],
    physics: "Grease, oil and the motor's own induced voltage resist the motor side with F = c v, in \
        addition to what the model has. Cold grease makes it several times larger. Source: \
        Armstrong-Helouvry, Control of Machines with Friction (1991), chapter 2.",
    remedy: "Check the lubricant's viscosity and temperature; add a term in proportion to the \
        velocity to the feedforward.",
    parameters: &[Parameter {
        name: "viscous",
        role: ParameterRole::Size,
        quantity: Quantity::new(1, -1, 1),
        bounds: |scales| (0.0, 10.0 * scales.force / scales.velocity),
        neutral: 0.0,
        typical: |scales| 0.1 * scales.force / scales.velocity,
    }],
    properties: &[
        Property::Alike(Likeness::ShiftInTime),
        Property::Slot(Slot::Friction),
    ],
    law: |p| Law::Force(Box::new(Viscous { coefficient: p[0] })),
    starts: |scales| sizes(scales.force / scales.velocity, [0.02, 0.3]),
};

//! A damper from the link to the ground.

use super::grid::sizes;
use super::viscous_friction::Viscous;
use super::{Effect, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Slot};

/// A force against the link in proportion to its speed: `F = c y'`.
pub const VISCOUS_DRAG: Effect = Effect {
    name: "viscous_drag",
    title: "viscous drag",
    places: &[Place::Link],
    physics: "A bearing, a hose or a fluid holds the link back with c y', against the ground and not \
        against the motor. In free vibration it is the same as damping across the joint; in motion at \
        speed v it bends the joint by c v / k, which is what a clock offset of c / k would show. \
        Source: Meirovitch, Fundamentals of Vibrations (2001), chapter 2.",
    remedy: "Damping acts between link and ground: look for cables, hoses and seals that do not \
        turn with the joint.",
    parameters: &[Parameter {
        name: "viscous",
        role: ParameterRole::Size,
        quantity: Quantity::new(1, -1, 1),
        bounds: |scales| (0.0, 10.0 * scales.force / scales.velocity),
        neutral: 0.0,
        typical: |scales| 0.1 * scales.force / scales.velocity,
    }],
    properties: &[
        Property::DampsToGround,
        Property::Alike(Likeness::ShiftInTime),
        Property::Slot(Slot::Friction),
    ],
    law: |p| Law::Force(Box::new(Viscous { coefficient: p[0] })),
    starts: |scales| sizes(scales.force / scales.velocity, [0.02, 0.3]),
};

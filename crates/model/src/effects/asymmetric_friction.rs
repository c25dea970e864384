//! Friction that depends on the direction.

use super::coulomb_friction::COULOMB_FRICTION;
use super::force_offset::FORCE_OFFSET;
use super::grid::product;
use super::shared_parameters::FRICTION;
use super::{
    Effect, Friction, Law, Likeness, Parameter, ParameterRole, Part, Place, Property, Quantity,
    Slot,
};

/// Coulomb friction of different size in the two directions: `F (1 + a)` and `F (1 - a)`.
pub const ASYMMETRIC_FRICTION: Effect = Effect {
    name: "asymmetric_friction",
    title: "asymmetric friction",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Dry friction is F (1 + a) in positive and F (1 - a) in negative motion: the flanks of \
        teeth wear on one side, seals have a lip, screws carry a load. Unlike a constant force it \
        does not act at rest, where friction holds. Source: Armstrong-Helouvry, Control of Machines \
        with Friction (1991), chapter 4.",
    remedy: "Look for a load or a preload that acts one way; compensate each direction by its own \
        friction.",
    parameters: &[
        FRICTION,
        Parameter {
            name: "asymmetry",
            role: ParameterRole::Shape,
            quantity: Quantity::NUMBER,
            // Friction dissipates in both directions.
            bounds: |_| (-1.0, 1.0),
            neutral: 0.0,
            typical: |_| 0.2,
        },
    ],
    properties: &[
        Property::Contains(&COULOMB_FRICTION),
        Property::Parts(parts),
        Property::Alike(Likeness::LowSpeed),
        Property::Slot(Slot::Friction),
    ],
    law: |p| {
        let friction = [p[0] * (1.0 + p[1]), p[0] * (1.0 - p[1])];
        Law::Friction(Friction {
            kinetic: friction,
            breakaway: friction,
            stribeck_velocity: 1.0,
            transition_velocity: 0.0,
            levels: None,
        })
    },
    starts: |scales| {
        let friction = [0.015, 0.06, 0.25].map(|size| size * scales.force);
        product(&[&friction, &[-0.5, 0.5]])
    },
};

/// In sliding, Coulomb friction `F` and a constant force `F a`. At rest they differ: the constant force
/// remains.
fn parts(values: &[f64]) -> [Part; 2] {
    let (friction, asymmetry) = (values[0], values[1]);
    [
        (&COULOMB_FRICTION, vec![friction]),
        (&FORCE_OFFSET, vec![friction * asymmetry]),
    ]
}

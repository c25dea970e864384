//! Coulomb friction.

use super::shared_parameters::FRICTION;
use super::{Effect, Friction, Law, Likeness, Place, Property, Slot};

/// Dry friction of one size, sticking and sliding.
pub const COULOMB_FRICTION: Effect = Effect {
    name: "coulomb_friction",
    title: "Coulomb friction",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Two surfaces pressed together stick until the force between them exceeds F, and slide \
        against F, whatever the speed. It dissipates the same energy in each cycle for each unit of \
        amplitude, so that free vibration decays along a straight line and stops away from its centre. \
        Source: Coulomb, Theorie des machines simples (1785); Armstrong-Helouvry, Dupont, Canudas de \
        Wit, Automatica 30 (1994).",
    remedy: "Check lubrication, preload and seals; compensate it with a term that changes sign with \
        the velocity.",
    parameters: &[FRICTION],
    properties: &[
        Property::Alike(Likeness::LowSpeed),
        Property::Slot(Slot::Friction),
    ],
    law: |p| {
        Law::Friction(Friction {
            kinetic: [p[0]; 2],
            breakaway: [p[0]; 2],
            stribeck_velocity: 1.0,
            transition_velocity: 0.0,
            levels: None,
        })
    },
    starts: |scales| {
        [0.005, 0.02, 0.05, 0.12, 0.3]
            .map(|size| vec![size * scales.force])
            .to_vec()
    },
};

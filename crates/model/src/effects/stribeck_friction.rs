//! Stribeck friction.

use super::coulomb_friction::COULOMB_FRICTION;
use super::grid::product;
use super::shared_parameters::{EXCESS, FRICTION, STRIBECK_VELOCITY, speeds};
use super::{Effect, Friction, Law, Likeness, Place, Property, Slot};

/// Dry friction that falls from its breakaway to its kinetic value as the slip gets faster.
pub const STRIBECK_FRICTION: Effect = Effect {
    name: "stribeck_friction",
    title: "Stribeck friction",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Lubricated surfaces stick until the force exceeds F (1 + excess), and slide against \
        F (1 + excess exp(-(v / v_s)^2)): at speed a film carries part of the load. The falling \
        slope makes slow motion jerk (stick-slip). With no excess it is Coulomb friction. Source: \
        Stribeck, Z. VDI 46 (1902); Bo and Pavelescu, Wear 82 (1982); Armstrong-Helouvry, Dupont, \
        Canudas de Wit, Automatica 30 (1994).",
    remedy: "Check the lubricant at low speed; avoid creeping moves, or compensate breakaway and \
        sliding friction apart.",
    parameters: &[FRICTION, EXCESS, STRIBECK_VELOCITY],
    properties: &[
        Property::Contains(&COULOMB_FRICTION),
        Property::Alike(Likeness::LowSpeed),
        Property::Slot(Slot::Friction),
    ],
    law: |p| {
        Law::Friction(Friction {
            kinetic: [p[0]; 2],
            breakaway: [p[0] * (1.0 + p[1]); 2],
            stribeck_velocity: p[2],
            transition_velocity: 0.0,
            levels: None,
        })
    },
    starts: |scales| {
        let (slow, fast) = speeds(scales.velocity, scales.deformation_rate);
        let friction = [0.01, 0.05, 0.2].map(|size| size * scales.force);
        // The two sides slip at the rate of the deformation, or a drive at the speed of the axis.
        let mut velocities = vec![0.03 * slow, 0.2 * slow];
        if fast > 5.0 * slow {
            velocities.extend([0.03 * fast, 0.2 * fast]);
        }
        product(&[&friction, &[0.6], &velocities])
    },
};

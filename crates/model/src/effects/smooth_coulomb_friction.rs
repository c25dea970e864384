//! Dry friction without a jump.

use super::coulomb_friction::COULOMB_FRICTION;
use super::grid::product;
use super::shared_parameters::{FRICTION, speeds};
use super::{
    Effect, Friction, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

/// Dry friction that grows smoothly with the slip velocity about rest: `F tanh(v / v_0)`.
pub const SMOOTH_COULOMB_FRICTION: Effect = Effect {
    name: "smooth_coulomb_friction",
    title: "smooth Coulomb friction",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Dry friction F tanh(v / v_0) does not hold: below v_0 it is a damper of F / v_0, and what a force \
        has moved creeps on. Greased bearings, seals and strands that rub in a cable do so, and most simulators \
        write dry friction in this way, as a jump cannot be integrated with a fixed step. With a small v_0 it is \
        Coulomb friction. Source: Andersson, Soderberg, Bjorklund, Friction models for sliding dry, boundary and \
        mixed lubricated contacts, Tribology International 40 (2007).",
    remedy: "Check lubrication, preload and seals; compensate it with a term that changes sign with \
        the velocity, as smoothly as the friction does.",
    parameters: &[
        FRICTION,
        Parameter {
            name: "transition_velocity",
            role: ParameterRole::Shape,
            quantity: Quantity::VELOCITY,
            // A velocity above the motion's makes it viscous.
            bounds: |scales| {
                let (slow, fast) = speeds(scales.velocity, scales.deformation_rate);
                (1e-3 * slow, fast)
            },
            neutral: 1.0,
            typical: |scales| 0.03 * speeds(scales.velocity, scales.deformation_rate).0,
        },
    ],
    properties: &[
        Property::Contains(&COULOMB_FRICTION),
        Property::Alike(Likeness::LowSpeed),
        Property::Slot(Slot::Friction),
    ],
    law: |p| {
        Law::Friction(Friction {
            kinetic: [p[0]; 2],
            breakaway: [0.0; 2],
            stribeck_velocity: 1.0,
            transition_velocity: p[1],
            levels: None,
        })
    },
    starts: |scales| {
        let (slow, fast) = speeds(scales.velocity, scales.deformation_rate);
        let friction = [0.02, 0.1, 0.3].map(|size| size * scales.force);
        // The two sides of a transmission slip at the rate of the deformation, a drive and a link at the speed
        // of the axis.
        let mut velocities = vec![0.01 * slow, 0.1 * slow];
        if fast > 5.0 * slow {
            velocities.extend([0.01 * fast, 0.1 * fast]);
        }
        product(&[&friction, &velocities])
    },
};

//! Stiction: a breakaway force above the kinetic one, at rest only.

use super::coulomb_friction::COULOMB_FRICTION;
use super::grid::product;
use super::{
    Effect, Friction, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

/// Slip velocity below which the breakaway force still acts: practically 0, in any unit.
const AT_REST: f64 = 1e-9;

/// Friction that sticks up to `F_s` and resists sliding with `ratio F_s`.
pub const STICTION: Effect = Effect {
    name: "stiction",
    title: "stiction",
    places: &[Place::Drive],
    physics: "At rest the surfaces weld at their asperities and hold up to F_s; as soon as they slide \
        only the kinetic friction ratio F_s remains. The axis waits, then jumps. It is Stribeck \
        friction whose velocity is too small to be seen. Source: Karnopp, ASME J. Dynamic Systems, \
        Measurement and Control 107 (1985); Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica \
        30 (1994).",
    remedy: "Check lubrication and preload; add the breakaway force to the command when the motion \
        starts.",
    parameters: &[
        Parameter {
            name: "breakaway",
            role: ParameterRole::Size,
            quantity: Quantity::FORCE,
            bounds: |scales| (0.0, scales.force),
            neutral: 0.0,
            typical: |scales| 0.1 * scales.force,
        },
        Parameter {
            name: "kinetic_ratio",
            role: ParameterRole::Shape,
            quantity: Quantity::NUMBER,
            // Kinetic friction is not above the breakaway force.
            bounds: |_| (0.0, 1.0),
            neutral: 0.0,
            typical: |_| 0.5,
        },
    ],
    properties: &[
        Property::Contains(&COULOMB_FRICTION),
        Property::Alike(Likeness::LowSpeed),
        Property::Slot(Slot::Friction),
    ],
    law: |p| {
        Law::Friction(Friction {
            kinetic: [p[0] * p[1]; 2],
            breakaway: [p[0]; 2],
            stribeck_velocity: AT_REST,
            transition_velocity: 0.0,
            levels: None,
        })
    },
    starts: |scales| {
        let breakaway = [0.01, 0.04, 0.1, 0.25, 0.5].map(|size| size * scales.force);
        product(&[&breakaway, &[0.1, 0.5, 0.85]])
    },
};

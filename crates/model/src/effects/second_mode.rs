//! A second mode of the arm.

use super::deformation_gain::DEFORMATION_GAIN;
use super::grid::{frequencies, frequency_bounds, product};
use super::shared_parameters::{DAMPING_COUPLING, DAMPING_RATIO};
use super::{
    Effect, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Resonance,
};

/// A further resonance that the sensor sees with a share of either sign.
pub const SECOND_MODE: Effect = Effect {
    name: "second_mode",
    title: "second mode",
    places: &[Place::Link],
    physics: "The arm is no single spring and mass: a further mode eta'' + 2 xi w eta' + 2 g w d' + w^2 eta is \
        driven as the first one is, and the sensor sees a share of it, negative where the mode's \
        shape has the other sign at the sensor. Where the dampers are not in the proportion of the springs, the \
        joint's damper acts on it as well: g is the coupling, d the deformation of the joint. Source: Meirovitch, \
        Fundamentals of Vibrations (2001), chapter 7; Ewins, Modal Testing (2000), chapter 2; Caughey and O'Kelly, \
        ASME J. Applied Mechanics 32 (1965).",
    remedy: "Shape for both frequencies; look for a flexible gripper, tool or payload at the \
        second.",
    parameters: &[
        Parameter {
            name: "share",
            role: ParameterRole::Size,
            quantity: Quantity::NUMBER,
            // If a moving base drives them, all modes together follow it, so that no share exceeds 1. Under a
            // force each mode has a gain of its own, which may be larger than the first one's.
            bounds: |scales| match scales.forced {
                true => (-3.0, 3.0),
                false => (-1.0, 1.0),
            },
            neutral: 0.0,
            typical: |scales| if scales.forced { 0.3 } else { 0.1 },
        },
        Parameter {
            name: "natural_frequency",
            role: ParameterRole::Frequency,
            quantity: Quantity::FREQUENCY,
            bounds: frequency_bounds,
            neutral: 1.0,
            typical: |scales| 2.5 * scales.natural_frequency,
        },
        Parameter {
            typical: |_| 0.03,
            ..DAMPING_RATIO
        },
        DAMPING_COUPLING,
    ],
    properties: &[
        Property::Optional("damping_coupling"),
        Property::Becomes(&DEFORMATION_GAIN),
        Property::Alike(Likeness::Resonance),
        Property::Alike(Likeness::Flexibility),
    ],
    law: |p| {
        Law::Resonance(Resonance {
            natural_frequency: p[1],
            damping_ratio: p[2],
            share: p[0],
            damping_coupling: p[3],
        })
    },
    starts: |scales| {
        let share = if scales.forced { 0.3 } else { 0.05 };
        product(&[&[-share, share], &frequencies(scales, 9), &[0.02], &[0.0]])
    },
};

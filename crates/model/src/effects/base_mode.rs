//! A robot on a soft base.

use super::deformation_gain::DEFORMATION_GAIN;
use super::grid::{frequencies, frequency_bounds, product};
use super::shared_parameters::{DAMPING_COUPLING, DAMPING_RATIO};
use super::{
    Effect, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Resonance,
};

/// A resonance under the robot that moves the sensor's target with the arm.
pub const BASE_MODE: Effect = Effect {
    name: "base_mode",
    title: "base mode",
    places: &[Place::Base],
    physics: "The base gives way to the reaction of the arm and swings too. Base and joint then share \
        two modes; the sensor sees the further one with a share of the joint's sign or of the other, \
        as the base's own frequency lies on one side of the joint's or on the other. Only its \
        frequency, or a sensor on the base, tells it from a mode of the arm. Source: Book, ASME J. \
        Dynamic Systems, Measurement, and Control 115 (1993); Lew and Moon, IEEE/ASME Trans. \
        Mechatronics 6 (2001).",
    remedy: "Look at how the machine is bolted down; put a sensor on the base, and shape for its \
        frequency as well.",
    parameters: &[
        Parameter {
            name: "share",
            role: ParameterRole::Size,
            quantity: Quantity::NUMBER,
            // Of either sign: the base moves with the reaction or against it, depending on whether its
            // resonance lies above or below the mode.
            bounds: |_| (-1.0, 1.0),
            neutral: 0.0,
            typical: |_| 0.1,
        },
        Parameter {
            name: "natural_frequency",
            role: ParameterRole::Frequency,
            quantity: Quantity::FREQUENCY,
            bounds: frequency_bounds,
            neutral: 1.0,
            typical: |scales| 1.5 * scales.natural_frequency,
        },
        DAMPING_RATIO,
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
    starts: |scales| product(&[&[-0.05, 0.05], &frequencies(scales, 9), &[0.04], &[0.0]]),
};

//! An impact from outside.

use super::grid::{product, times};
use super::shared_parameters::EVENT_TIME;
use super::{Effect, Law, Parameter, ParameterRole, Place, Property, Quantity};

/// An impulse on the link: its velocity jumps at a time.
pub const EXTERNAL_DISTURBANCE: Effect = Effect {
    name: "external_disturbance",
    title: "external disturbance",
    places: &[Place::Environment],
    physics: "Something knocks against the link, for a time that is short against its period: the velocity \
        jumps by J / m and the link rings freely. Source: Haddadin, De Luca, Albu-Schaeffer, Robot \
        collisions: a survey on detection, isolation, and identification, IEEE Trans. Robotics 33 \
        (2017).",
    remedy: "Find out what touched the machine at these times; leave those stretches out.",
    parameters: &[
        Parameter {
            name: "jump",
            role: ParameterRole::Size,
            quantity: Quantity::VELOCITY,
            bounds: |scales| {
                let most = 20.0 * scales.deformation_rate;
                (-most, most)
            },
            neutral: 0.0,
            typical: |scales| 0.2 * scales.deformation_rate,
        },
        EVENT_TIME,
    ],
    properties: &[Property::Recurs],
    law: |p| Law::Impulse {
        size: p[0],
        time: p[1],
    },
    starts: |scales| {
        let jumps = [-0.1, 0.1].map(|size| size * scales.deformation_rate);
        product(&[&jumps, &times(scales, 12)])
    },
};

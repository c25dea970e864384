//! An impact from outside.

use super::grid::{product, times};
use super::shared_parameters::EVENT_TIME;
use super::{Effect, Impulse, Law, Parameter, ParameterRole, Place, Property, Quantity, Scales};

/// A duration that a mode hardly tells from a jump: the first part of the difference is `(w d)^2 / 40`.
fn typical(scales: &Scales) -> f64 {
    0.1 * scales.period()
}

/// An impulse on the link: a parabola of force, or a jump of its velocity.
pub const EXTERNAL_DISTURBANCE: Effect = Effect {
    name: "external_disturbance",
    title: "external disturbance",
    places: &[Place::Environment],
    physics: "Something knocks against the link: its velocity changes by J / m and it rings freely. The force is a parabola \
        that lasts for d, F = 3 J / (2 d) (1 - (2 (t - t_0) / d)^2), as half a sine of an elastic contact within 5 %. An \
        accelerometer shows d; a sensor of positions does where its noise is well below J d / m, else the velocity jumps. Source: Haddadin, De Luca, Albu-Schaeffer, Robot collisions: a \
        survey on detection, isolation, and identification, IEEE Trans. Robotics 33 (2017).",
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
        Parameter {
            name: "duration",
            role: ParameterRole::Shape,
            quantity: Quantity::TIME,
            // What presses for longer than a period is no knock. Where it is a hundredth of it, it is a jump.
            bounds: |scales| (0.01 * scales.period(), scales.period()),
            neutral: 0.0,
            typical,
        },
    ],
    properties: &[Property::Recurs, Property::Vanish(&["duration"])],
    law: |p| {
        Law::Impulse(Impulse {
            size: p[0],
            time: p[1],
            duration: p[2],
        })
    },
    starts: |scales| {
        let jumps = [-0.1, 0.1].map(|size| size * scales.deformation_rate);
        product(&[&jumps, &times(scales, 12), &[typical(scales)]])
    },
};

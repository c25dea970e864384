//! Weight of the link.

use super::force_offset::FORCE_OFFSET;
use super::grid::{PHASES, product};
use super::shared_parameters::PHASE;
use super::{
    Effect, Force, Law, Likeness, Memory, Motion, Parameter, ParameterRole, Place, Property,
    Quantity, Slot,
};

struct Gravity {
    amplitude: f64,
    phase: f64,
}

impl Force for Gravity {
    fn force(&self, _motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        self.amplitude * (x + self.phase).cos()
    }
}

/// The link's weight at its angle: `F = A cos(y + phase)`.
pub const GRAVITY_LOAD: Effect = Effect {
    name: "gravity_load",
    title: "gravity load",
    places: &[Place::Link],
    physics: "The weight m g at a distance l from the axis resists with A cos(y + phase), A = m g l \
        times the sine of the axis' tilt; the link hangs like a pendulum, so that the static \
        deformation and, a little, the stiffness depend on the pose. A tilted sensor shows nearly the \
        same. Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and \
        Control (2009), chapter 7.",
    remedy: "Put the payload's weight and its lever into the model, or balance it.",
    parameters: &[
        Parameter {
            name: "amplitude",
            role: ParameterRole::Size,
            quantity: Quantity::FORCE,
            bounds: |scales| (0.0, 20.0 * scales.force),
            neutral: 0.0,
            typical: |scales| 0.1 * scales.force,
        },
        PHASE,
    ],
    properties: &[
        // The limit for a small range of angles.
        Property::Contains(&FORCE_OFFSET),
        Property::Alike(Likeness::Pose),
        Property::Slot(Slot::PositionForce),
    ],
    law: |p| {
        Law::Force(Box::new(Gravity {
            amplitude: p[0],
            phase: p[1],
        }))
    },
    starts: |scales| {
        let amplitudes = [0.05, 0.6].map(|size| size * scales.force);
        product(&[&amplitudes, &PHASES])
    },
};

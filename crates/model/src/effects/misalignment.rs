//! A sensor whose axis is off the joint's axis.

use super::grid::{PHASES, product, reach};
use super::shared_parameters::PHASE;
use super::{
    Effect, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Reading, Sensor,
};

struct Eccentricity {
    amplitude: f64,
    phase: f64,
}

impl Sensor for Eccentricity {
    fn read(&self, reading: &Reading) -> f64 {
        reading.value + self.amplitude * (reading.value + self.phase).sin()
    }
}

/// An error with one period per turn: `y + A sin(y + phase)`.
pub const MISALIGNMENT: Effect = Effect {
    name: "misalignment",
    title: "misalignment",
    places: &[Place::Sensor],
    physics: "A disc or a target that is off the axis by e at a radius r shows y + (e / r) sin(y + \
        phase); an axis that is tilted against the sensor's frame does nearly the same. It depends \
        on the pose only, moving or not. Source: Slocum, Precision Machine Design (1992), chapter 5; \
        ISO 230-7, Geometric accuracy of axes of rotation.",
    remedy: "Align the sensor's axis with the direction of motion, or calibrate its frame.",
    parameters: &[
        Parameter {
            name: "amplitude",
            role: ParameterRole::Size,
            quantity: Quantity::POSITION,
            bounds: |scales| (0.0, reach(scales)),
            neutral: 0.0,
            typical: |scales| 0.1 * scales.deformation,
        },
        PHASE,
    ],
    properties: &[Property::Alike(Likeness::Pose)],
    law: |p| {
        Law::Sensor(Box::new(Eccentricity {
            amplitude: p[0],
            phase: p[1],
        }))
    },
    starts: |scales| product(&[&[0.1 * scales.deformation], &PHASES]),
};

//! A constant force on the drive.

use super::grid::sizes;
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

struct Offset {
    force: f64,
}

impl Force for Offset {
    fn force(&self, _motion: &Motion, _x: f64, _v: f64, _memory: &Memory) -> f64 {
        self.force
    }
}

/// A constant force that resists positive motion.
pub const FORCE_OFFSET: Effect = Effect {
    name: "force_offset",
    title: "force offset",
    places: &[Place::Drive],
    physics: "A constant force F acts on the motor side: the amplifier's offset, a weight, a \
        counterbalance, the constant part of a friction that differs between the directions. \
        Source: Janot, Gautier, Brunot, Data set and reference models of EMPS, Workshop on \
        Nonlinear System Identification Benchmarks (2019).",
    remedy: "Look for a bias of the amplifier, gravity or a spring that pulls one way; add the \
        constant to the feedforward.",
    parameters: &[Parameter {
        name: "force",
        role: ParameterRole::Size,
        quantity: Quantity::FORCE,
        bounds: |scales| (-2.0 * scales.force, 2.0 * scales.force),
        neutral: 0.0,
        typical: |scales| 0.05 * scales.force,
    }],
    properties: &[Property::Slot(Slot::PositionForce)],
    law: |p| Law::Force(Box::new(Offset { force: p[0] })),
    starts: |scales| sizes(scales.force, [-0.05, 0.05]),
};

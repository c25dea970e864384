//! A drive whose torque per ampere falls with the current.

use super::grid::product;
use super::{Drive, Effect, Law, Parameter, ParameterRole, Place, Property, Quantity, Slot};

struct Droop {
    droop: f64,
    order: f64,
}

impl Drive for Droop {
    /// Beyond its peak at `a |u| = (1 + n)^(-1/n)` the output is constant.
    fn map(&self, value: f64) -> f64 {
        if self.droop == 0.0 {
            return value;
        }
        let peak = (1.0 + self.order).powf(-1.0 / self.order) / self.droop;
        let size = value.abs().min(peak);
        value.signum() * size * (1.0 - (self.droop * size).powf(self.order))
    }
}

/// A torque constant that falls with the input: `u (1 - (a |u|)^n)`.
pub const TORQUE_CONSTANT_NONLINEARITY: Effect = Effect {
    name: "torque_constant_nonlinearity",
    title: "torque constant nonlinearity",
    places: &[Place::Drive],
    physics: "Iron saturates: at large current the torque constant falls, u (1 - (a |u|)^n), with n = 2 where \
        the iron is alike in both directions and far from full, less where it is biased by its magnets, more \
        where it fills at once. Where the nominal constant was read at large current it seems to rise at small \
        ones, which is the same law with another constant. Source: Hanselman, Brushless Permanent Magnet \
        Motor Design (2003); Krishnan, Electric Motor Drives (2001).",
    remedy: "Correct the torque constant for high currents, where the iron saturates.",
    parameters: &[
        Parameter {
            name: "droop",
            role: ParameterRole::Size,
            quantity: Quantity::driven(-1, 0),
            // At a step of the reference a controller may request a multiple of the drive's limit.
            bounds: |scales| (0.0, 10.0 / scales.input),
            neutral: 0.0,
            typical: |scales| 0.3 / scales.input,
        },
        Parameter {
            name: "order",
            role: ParameterRole::Shape,
            quantity: Quantity::NUMBER,
            bounds: |_| (1.0, 4.0),
            neutral: 1.0,
            typical: |_| 1.0,
        },
    ],
    properties: &[Property::Slot(Slot::Drive)],
    law: |p| {
        Law::Drive(Box::new(Droop {
            droop: p[0],
            order: p[1],
        }))
    },
    starts: |scales| {
        let droops = [0.05, 0.15, 0.45, 1.5, 5.0].map(|droop| droop / scales.input);
        product(&[&droops, &[1.0, 2.0]])
    },
};

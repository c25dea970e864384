//! A drive that gives less for each ampere the more it is asked for.

use super::grid::sizes;
use super::{Drive, Effect, Law, Parameter, Place, Quantity};

struct Droop {
    droop: f64,
}

impl Drive for Droop {
    /// Beyond the peak at `|u| = 1 / (2 a)` more input gives no more.
    fn map(&self, value: f64) -> f64 {
        if self.droop == 0.0 {
            return value;
        }
        let size = value.abs().min(0.5 / self.droop.abs());
        value.signum() * size * (1.0 - self.droop * size)
    }
}

/// A torque constant that falls with the input: `u (1 - a |u|)`.
pub const TORQUE_CONSTANT_NONLINEARITY: Effect = Effect {
    name: "torque_constant_nonlinearity",
    places: &[Place::Drive],
    physics: "Iron saturates: at large current the torque constant falls, u (1 - a |u|) to first order. \
        Where the nominal constant was read at large current it seems to rise at small ones, which is \
        the same law with another constant. Source: Hanselman, Brushless Permanent Magnet Motor \
        Design (2003); Krishnan, Electric Motor Drives (2001).",
    parameters: &[Parameter {
        name: "droop",
        quantity: Quantity::driven(-1, 0),
        // More current never gives less torque.
        bounds: |scales| (0.0, 0.5 / scales.input),
        neutral: 0.0,
        typical: |scales| 0.1 / scales.input,
    }],
    law: |p| Law::Drive(Box::new(Droop { droop: p[0] })),
    starts: |scales| sizes(1.0 / scales.input, [0.01, 0.05, 0.15, 0.35]),
};

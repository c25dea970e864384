//! A drive that ignores small inputs.

use super::grid::sizes;
use super::{Drive, Effect, Law, Parameter, ParameterRole, Place, Property, Quantity, Slot};

struct DeadZone {
    half_width: f64,
}

impl Drive for DeadZone {
    fn map(&self, value: f64) -> f64 {
        if self.half_width == 0.0 {
            return value;
        }
        value.signum() * (value.abs() - self.half_width).max(0.0)
    }
}

/// 0 for inputs up to `w`, and the excess beyond: `sign(u) max(|u| - w, 0)`.
pub const DEAD_ZONE: Effect = Effect {
    name: "dead_zone",
    title: "dead zone",
    places: &[Place::Drive],
    physics: "The drive gives nothing until its input exceeds w, and the excess beyond: overlap of a \
        valve, dead time of an inverter's switches, a threshold in the amplifier. Near rest it looks \
        like stiction, at speed like a constant loss. Source: Tao and Kokotovic, Adaptive Control of \
        Systems with Actuator and Sensor Nonlinearities (1996), chapter 2.",
    remedy: "Check the amplifier's offset and dead band; add the breakaway value to small commands.",
    parameters: &[Parameter {
        name: "half_width",
        role: ParameterRole::Size,
        quantity: Quantity::INPUT,
        bounds: |scales| (0.0, scales.input),
        neutral: 0.0,
        typical: |scales| 0.05 * scales.input,
    }],
    properties: &[Property::Slot(Slot::Drive)],
    law: |p| Law::Drive(Box::new(DeadZone { half_width: p[0] })),
    starts: |scales| sizes(scales.input, [0.005, 0.015, 0.04, 0.1, 0.2, 0.4, 0.7]),
};

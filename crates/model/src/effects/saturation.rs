//! A drive that gives no more than its limit.

use super::grid::sizes;
use super::{Drive, Effect, Law, Parameter, ParameterRole, Place, Property, Quantity, Slot};

struct Saturation {
    limit: f64,
}

impl Drive for Saturation {
    fn map(&self, value: f64) -> f64 {
        match self.limit > 0.0 {
            true => value.clamp(-self.limit, self.limit),
            false => value,
        }
    }
}

/// The input, but not beyond the limit: `max(-L, min(u, L))`. A limit of 0 stands for none.
pub const SATURATION: Effect = Effect {
    name: "saturation",
    title: "saturation",
    places: &[Place::Drive],
    physics: "An amplifier gives no more than its supply and its protection allow: what is asked \
        beyond L is cut off, so that fast moves fall short while slow ones are as modelled. Source: \
        Khalil, Nonlinear Systems (2002), section 1.2; Hippe, Windup in Control (2006).",
    remedy: "Lower the acceleration so that the amplifier's limit is not reached, or raise the \
        limit.",
    parameters: &[Parameter {
        name: "limit",
        role: ParameterRole::Size,
        quantity: Quantity::INPUT,
        bounds: |scales| (0.0, 1.5 * scales.input),
        neutral: 0.0,
        typical: |scales| 0.7 * scales.input,
    }],
    properties: &[Property::Slot(Slot::Drive)],
    law: |p| Law::Drive(Box::new(Saturation { limit: p[0] })),
    starts: |scales| {
        sizes(
            scales.input,
            [0.98, 0.95, 0.9, 0.8, 0.7, 0.55, 0.4, 0.2, 0.1, 0.05],
        )
    },
};

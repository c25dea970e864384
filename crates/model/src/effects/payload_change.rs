//! A payload that is gripped or released.

use super::grid::{product, times};
use super::shared_parameters::EVENT_TIME;
use super::{Effect, Inertia, Law, Parameter, ParameterRole, Place, Quantity};

struct Payload {
    change: f64,
    time: f64,
}

impl Inertia for Payload {
    fn factor(&self, time: f64, _position: f64) -> f64 {
        match time >= self.time {
            true => 1.0 + self.change,
            false => 1.0,
        }
    }

    fn breaks(&self) -> Vec<f64> {
        match self.change == 0.0 {
            true => Vec::new(),
            false => vec![self.time],
        }
    }
}

/// The link's inertia is multiplied by `1 + a` from a given time on.
pub const PAYLOAD_CHANGE: Effect = Effect {
    name: "payload_change",
    title: "payload change",
    places: &[Place::Link],
    physics: "From t_0 on the link's inertia is 1 + a times the one before: something was gripped, set \
        down or lost. The frequency of vibration changes by 1 / sqrt(1 + a) at once. Source: Khalil, \
        Gautier, Lemoine, Identification of the payload inertial parameters of industrial \
        manipulators, IEEE ICRA (2007).",
    remedy: "Tell the controller of the payload, or let it identify the frequency after each grip.",
    parameters: &[
        Parameter {
            name: "change",
            role: ParameterRole::Size,
            quantity: Quantity::NUMBER,
            // Inertia stays positive.
            bounds: |_| (-0.9, 10.0),
            neutral: 0.0,
            typical: |_| 0.2,
        },
        EVENT_TIME,
    ],
    properties: &[],
    law: |p| {
        Law::Inertia(Box::new(Payload {
            change: p[0],
            time: p[1],
        }))
    },
    starts: |scales| {
        // Large changes, and those that shift the frequency by the half width of its peak, if that is less. A
        // lightly damped mode loses the phase before it has decayed if the shift is larger.
        let width = (2.0 * scales.damping_ratio).min(0.1);
        product(&[&[-0.15, -width, width, 0.2], &times(scales, 12)])
    },
};

//! Stiffness that changes with time.

use super::grid::product;
use super::levelling::{SETTLING_RATE, levelling};
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

struct Drift {
    rate: f64,
    settling: f64,
}

impl Force for Drift {
    fn force(&self, motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        motion.stiffness * self.rate * levelling(motion.time, self.settling) * x
    }
}

/// Stiffness that rises or falls, steadily or levelling off: `F = k (1 + a (1 - exp(-s t)) / s) x`.
pub const STIFFNESS_DRIFT: Effect = Effect {
    name: "stiffness_drift",
    title: "stiffness drift",
    places: &[Place::Transmission],
    physics: "The stiffness is k (1 + a t): a gear that warms up, a clamp that works loose, a belt that \
        loses tension. The frequency drifts by a / 2 for each second. With s > 0 it levels off, as what \
        warms up does: k (1 + a (1 - exp(-s t)) / s). Source: Farrar and Worden, Structural Health \
        Monitoring (2013), chapter 12.",
    remedy: "Look for warming up or a loosening screw; identify the frequency anew while it works.",
    parameters: &[
        Parameter {
            name: "rate",
            role: ParameterRole::Size,
            quantity: Quantity::FREQUENCY,
            // The spring keeps a positive stiffness: 1 + a t > 0.
            bounds: |scales| {
                let latest = latest(scales.span);
                (-0.9 / latest, 5.0 / latest)
            },
            neutral: 0.0,
            typical: |scales| 0.1 / latest(scales.span),
        },
        SETTLING_RATE,
    ],
    properties: &[Property::Slot(Slot::StiffnessDrift)],
    law: |p| {
        Law::Force(Box::new(Drift {
            rate: p[0],
            settling: p[1],
        }))
    },
    starts: |scales| {
        let rates = [-0.1, 0.1].map(|size| size / latest(scales.span));
        product(&[&rates, &[0.0, 4.0 / scales.duration()]])
    },
};

/// The instant farthest from 0.
fn latest(span: (f64, f64)) -> f64 {
    span.0.abs().max(span.1.abs())
}

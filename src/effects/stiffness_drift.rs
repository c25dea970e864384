//! Stiffness that changes with time.

use super::grid::sizes;
use super::{Effect, Force, Law, Memory, Motion, Parameter, Place, Quantity};

struct Drift {
    rate: f64,
}

impl Force for Drift {
    fn force(&self, motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        motion.stiffness * self.rate * motion.time * x
    }
}

/// Stiffness that rises or falls steadily: `F = k (1 + a t) x`.
pub const STIFFNESS_DRIFT: Effect = Effect {
    name: "stiffness_drift",
    places: &[Place::Transmission],
    physics: "The stiffness is k (1 + a t): a gear that warms up, a clamp that works loose, a belt that \
        loses tension. The frequency drifts by a / 2 for each second. Source: Farrar and Worden, \
        Structural Health Monitoring (2013), chapter 12.",
    parameters: &[Parameter {
        name: "rate",
        quantity: Quantity::FREQUENCY,
        // The spring keeps a positive stiffness: 1 + a t > 0.
        bounds: |scales| {
            let latest = latest(scales.span);
            (-0.9 / latest, 5.0 / latest)
        },
        neutral: 0.0,
        typical: |scales| 0.1 / latest(scales.span),
    }],
    law: |p| Law::Force(Box::new(Drift { rate: p[0] })),
    starts: |scales| sizes(1.0 / latest(scales.span), [-0.1, 0.1]),
};

/// The instant farthest from 0.
fn latest(span: (f64, f64)) -> f64 {
    span.0.abs().max(span.1.abs())
}

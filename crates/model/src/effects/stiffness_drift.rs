//! Stiffness that changes with time.

use super::levelling::{SETTLING_RATE, levelling};
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity,
    Scales, Slot,
};

/// The spring keeps a positive stiffness.
const GREATEST_LOSS: f64 = -0.9;

struct Drift {
    rate: f64,
    settling: f64,
}

impl Force for Drift {
    fn force(&self, motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        let change = self.rate * levelling(motion.time, self.settling);
        motion.stiffness * change.max(GREATEST_LOSS) * x
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
            // What levels off fastest has the steepest beginning.
            bounds: |scales| {
                let steepest = 1.0 / levelled(scales, (SETTLING_RATE.bounds)(scales).1);
                (GREATEST_LOSS * steepest, 5.0 * steepest)
            },
            neutral: 0.0,
            typical: |scales| 0.1 / levelled(scales, 0.0),
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
        let courses = [0.0, 4.0 / scales.duration()].into_iter();
        let start = |settling| {
            let whole = levelled(scales, settling);
            [-0.1, 0.1].map(|size| vec![size / whole, settling])
        };
        courses.flat_map(start).collect()
    },
};

/// The course of a drift at the instant farthest from 0.
fn levelled(scales: &Scales, settling: f64) -> f64 {
    let (first, last) = scales.span;
    levelling(first.abs().max(last.abs()), settling)
}

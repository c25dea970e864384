//! Stiffness that changes with time in any way.

use super::learned::{PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Force, Law, Memory, Motion, Place, Property, Quantity, Slot, Spline};

struct Drift(Spline);

impl Force for Drift {
    fn force(&self, motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        motion.stiffness * self.0.not_less(motion.time) * x
    }
}

/// Stiffness that changes slowly: `F = k (1 + f(t)) x`.
pub const LEARNED_DRIFT: Effect = Effect {
    name: "learned_drift",
    title: "learned stiffness drift",
    places: &[Place::Transmission],
    physics: "The stiffness is k (1 + f(t)): a gear that warms up and cools down, a clamp that works loose. The curve \
        is learned: a cubic spline through its values at equally spaced times, outside of the recording of constant \
        slope where it rises, else constant. Source: Farrar and Worden, Structural Health Monitoring (2013), chapter 12.",
    remedy: "Look for warming up or a loosening screw; identify the frequency anew while it works.",
    parameters: &parameters::<PARAMETERS>(
        ordinate(Quantity::NUMBER, |_| (-0.9, 5.0), |_| 0.05),
        Quantity::TIME,
    ),
    properties: &[Property::Slot(Slot::StiffnessDrift)],
    law: |p| Law::Force(Box::new(Drift(spline(p)))),
    starts: |scales| vec![start::<PARAMETERS>(scales.span)],
};

//! Damping that changes with time in any way.

use super::learned::{PARAMETERS, parameters, split, start};
use super::learned_damping::{COEFFICIENT, beside};
use super::{Effect, Force, Law, Memory, Motion, Place, Property, Quantity, Slot, Spline};

struct Drift(Spline);

impl Force for Drift {
    fn force(&self, motion: &Motion, _x: f64, v: f64, _memory: &Memory) -> f64 {
        beside(motion, self.0.nearest(motion.time)) * v
    }
}

/// Damping that changes slowly, beside that of the model's damper: `F = c(t) x'`, `c` of mean 0.
pub const LEARNED_DAMPING_DRIFT: Effect = Effect {
    name: "learned_damping_drift",
    title: "learned damping drift",
    places: &[Place::Transmission],
    physics: "The damper's coefficient differs from c by a curve over time: grease that warms up and thins, a damper that \
        leaks, a clamp or a cable that is moved. The curve is learned: a cubic spline through its values at equally spaced \
        times, less their mean, which is in c; constant outside of the recording; the whole coefficient is never below 0. Source: Farrar and Worden, \
        Structural Health Monitoring (2013), chapter 12.",
    remedy: "Look for warming up or a loosening part; identify the damping anew while it works.",
    parameters: &parameters::<PARAMETERS>(COEFFICIENT, Quantity::TIME),
    properties: &[Property::Slot(Slot::DampingDrift)],
    law: |p| {
        // The mean is the machine's, and stays in the model where the change does not go with it.
        let (ordinates, from, to) = split(p);
        let mean = ordinates.iter().sum::<f64>() / ordinates.len().max(1) as f64;
        let about: Vec<f64> = ordinates.iter().map(|y| y - mean).collect();
        Law::Force(Box::new(Drift(Spline::new(from, to, &about))))
    },
    starts: |scales| vec![start::<PARAMETERS>(scales.span)],
};

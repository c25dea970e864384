//! Creep of a viscoelastic transmission.

use super::grid::product;
use super::{Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Quantity};

struct Maxwell {
    stiffness: f64,
    time_constant: f64,
}

impl Maxwell {
    /// Deformation `e` of the branch's spring, `e' = x' - e / T`. Exact if `x` is linear within the step.
    fn elastic(&self, time: f64, x: f64, memory: &Memory) -> f64 {
        let steps = (time - memory.time).max(0.0) / self.time_constant;
        let decayed = -(-steps).exp_m1();
        let mean = if steps > 0.0 { decayed / steps } else { 1.0 };
        memory.state * (1.0 - decayed) + (x - memory.position) * mean
    }
}

impl Force for Maxwell {
    fn force(&self, motion: &Motion, x: f64, _v: f64, memory: &Memory) -> f64 {
        motion.stiffness * self.stiffness * self.elastic(motion.time, x, memory)
    }

    fn advance(&self, motion: &Motion, x: f64, _v: f64, memory: &Memory) -> f64 {
        self.elastic(motion.time, x, memory)
    }
}

/// A Maxwell branch beside the spring: `F = k (x + a e)`, `e' = x' - e / T`.
pub const VISCOELASTIC_CREEP: Effect = Effect {
    name: "viscoelastic_creep",
    title: "viscoelastic creep",
    places: &[Place::Transmission],
    physics: "Beside the spring acts another one, of stiffness a k, in series with a damper: F = k (x + a \
        e), e' = x' - e / T. Fast motion meets k (1 + a), slow motion k, and after a step the \
        transmission creeps with the time constant T, as rubber, belts and glued joints do. Source: \
        Zener, Elasticity and Anelasticity of Metals (1948); Ferry, Viscoelastic Properties of \
        Polymers (1980).",
    remedy: "Look for belts, bonded joints and polymer parts; wait for the creep or model it.",
    parameters: &[
        Parameter {
            name: "relative_stiffness",
            role: ParameterRole::Size,
            quantity: Quantity::NUMBER,
            bounds: |_| (0.0, 10.0),
            neutral: 0.0,
            typical: |_| 0.2,
        },
        Parameter {
            name: "time_constant",
            role: ParameterRole::Shape,
            quantity: Quantity::TIME,
            bounds: |scales| {
                let longest = scales.duration().max(30.0 * scales.period());
                // A branch that relaxes within w T = 0.3 is a damper, as the model has one: c = a k T.
                (0.05 * scales.period(), 3.0 * longest)
            },
            neutral: 1.0,
            typical: |scales| scales.period(),
        },
    ],
    properties: &[],
    law: |p| {
        Law::Force(Box::new(Maxwell {
            stiffness: p[0],
            time_constant: p[1].max(f64::MIN_POSITIVE),
        }))
    },
    starts: |scales| {
        let times = [0.08, 0.25, 0.7, 2.5, 10.0, 30.0].map(|size| size * scales.period());
        product(&[&[0.08, 0.5], &times])
    },
};

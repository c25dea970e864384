//! A piecewise linear spring.

use super::grid::product;
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

struct Bilinear {
    /// Relative change of stiffness beyond the knee, for positive and for negative deformation.
    change: [f64; 2],
    knee: f64,
}

impl Force for Bilinear {
    fn force(&self, motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        let above = self.change[0] * (x - self.knee).max(0.0);
        let below = self.change[1] * (x + self.knee).min(0.0);
        motion.stiffness * (above + below)
    }

    fn switch(&self, _motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> Option<f64> {
        (self.change != [0.0; 2]).then(|| x.abs() - self.knee)
    }
}

/// A spring whose stiffness changes at a knee: `F = k (x + a_+ max(x - b, 0) + a_- min(x + b, 0))`,
/// `a_+ = a (1 + s)`, `a_- = a (1 - s)`.
pub const BILINEAR_STIFFNESS: Effect = Effect {
    name: "bilinear_stiffness",
    title: "bilinear stiffness",
    places: &[Place::Transmission],
    physics: "Beyond a deformation b the stiffness is k (1 + a): the soft wind-up of a harmonic drive, a \
        second row of teeth, a bumper. With an asymmetry s it changes by a (1 + s) for positive and \
        a (1 - s) for negative deformation: a crack that opens, a preload that lifts off. Source: \
        Shaw and Holmes, J. Sound and Vibration 90 (1983); Tuttle and Seering, IEEE Trans. Robotics \
        and Automation 12 (1996).",
    remedy: "Look for a preload that lifts off or a stop that is touched on one side; shape for \
        both frequencies.",
    parameters: &[
        Parameter {
            name: "change",
            role: ParameterRole::Size,
            quantity: Quantity::NUMBER,
            // Both slopes stay positive: 1 + a (1 +- s) > 0.
            bounds: |_| (-0.49, 10.0),
            neutral: 0.0,
            typical: |_| 0.3,
        },
        Parameter {
            name: "knee",
            role: ParameterRole::Shape,
            quantity: Quantity::POSITION,
            bounds: |scales| (0.0, 1.2 * scales.deformation),
            neutral: 0.0,
            typical: |scales| 0.3 * scales.deformation,
        },
        Parameter {
            name: "asymmetry",
            role: ParameterRole::Shape,
            quantity: Quantity::NUMBER,
            bounds: |_| (-1.0, 1.0),
            neutral: 0.0,
            typical: |_| 0.2,
        },
    ],
    properties: &[Property::Slot(Slot::Spring)],
    law: |p| {
        Law::Force(Box::new(Bilinear {
            change: [p[0] * (1.0 + p[2]), p[0] * (1.0 - p[2])],
            knee: p[1],
        }))
    },
    starts: |scales| {
        let knees = [0.08, 0.25, 0.6].map(|size| size * scales.deformation);
        let mut starts = product(&[&[-0.3, 0.4, 2.5], &knees, &[0.0]]);
        // One-sided, with the knee where the deformation changes sign.
        starts.extend(product(&[
            &[-0.2, 0.2],
            &[0.1 * scales.deformation],
            &[0.9, -0.9],
        ]));
        starts
    },
};

//! Drag of a fluid on the link.

use super::grid::sizes;
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

struct Drag {
    coefficient: f64,
}

impl Force for Drag {
    fn force(&self, _motion: &Motion, _x: f64, v: f64, _memory: &Memory) -> f64 {
        self.coefficient * v * v.abs()
    }
}

/// A force against the link with the square of its speed: `F = c y' |y'|`.
pub const QUADRATIC_DRAG: Effect = Effect {
    name: "quadratic_drag",
    title: "quadratic drag",
    places: &[Place::Link],
    physics: "Air or water resists the link with c y' |y'| once the flow separates, above a Reynolds \
        number of about 1000. Slow moves do not see it. Source: Hoerner, Fluid-Dynamic Drag (1965), \
        chapter 3; Morison, Johnson, Schaaf, J. Petroleum Technology 2 (1950).",
    remedy: "Look for resistance of air or fluid; it matters at high speed only.",
    parameters: &[Parameter {
        name: "coefficient",
        role: ParameterRole::Size,
        quantity: Quantity::new(1, -2, 2),
        bounds: |scales| (0.0, 10.0 * scales.force / scales.velocity.powi(2)),
        neutral: 0.0,
        typical: |scales| 0.1 * scales.force / scales.velocity.powi(2),
    }],
    properties: &[Property::Slot(Slot::Friction)],
    law: |p| Law::Force(Box::new(Drag { coefficient: p[0] })),
    starts: |scales| sizes(scales.force / scales.velocity.powi(2), [0.02, 0.3]),
};

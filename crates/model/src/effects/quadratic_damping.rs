//! Damping that grows with the square of the rate.

use super::grid::sizes;
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

struct Quadratic {
    coefficient: f64,
}

impl Force for Quadratic {
    fn force(&self, _motion: &Motion, _x: f64, v: f64, _memory: &Memory) -> f64 {
        self.coefficient * v * v.abs()
    }
}

/// A force across the transmission against the square of the rate: `F = c d' |d'|`.
pub const QUADRATIC_DAMPING: Effect = Effect {
    name: "quadratic_damping",
    title: "quadratic damping",
    places: &[Place::Transmission],
    physics: "Oil that is pressed through a gap, or a damper's orifice, resists with c d' |d'|. Its \
        equivalent damping grows with the amplitude A, 8 / (3 pi) c w A, so that free vibration \
        decays fast at first and slowly later. Source: Jacobsen, Trans. ASME 52 (1930); Nayfeh and \
        Mook, Nonlinear Oscillations (1979).",
    remedy: "Expect large vibration to die out faster than small; take the damping at the amplitude \
        that matters.",
    parameters: &[Parameter {
        name: "coefficient",
        role: ParameterRole::Size,
        quantity: Quantity::new(1, -2, 2),
        bounds: |scales| (0.0, 10.0 * scales.force / scales.deformation_rate.powi(2)),
        neutral: 0.0,
        typical: |scales| 0.1 * scales.force / scales.deformation_rate.powi(2),
    }],
    properties: &[Property::Slot(Slot::Friction)],
    law: |p| Law::Force(Box::new(Quadratic { coefficient: p[0] })),
    starts: |scales| {
        let unit = scales.force / scales.deformation_rate.powi(2);
        sizes(unit, [0.02, 0.1, 0.4])
    },
};

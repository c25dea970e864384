//! A spring with a hysteresis loop after Bouc and Wen.

use super::grid::product;
use super::presliding_hysteresis::PRESLIDING_HYSTERESIS;
use super::{
    Effect, Force, Law, Likeness, Memory, Motion, Parameter, ParameterRole, Place, Property,
    Quantity, Slot,
};

struct BoucWen {
    share: f64,
    /// Yield of the hysteretic part as it grows and as it shrinks.
    growing: Yield,
    shrinking: Yield,
}

/// `dz/du = 1 - a z - b z^2`, a Riccati equation with constant coefficients.
#[derive(Clone, Copy)]
struct Yield {
    linear: f64,
    quadratic: f64,
}

impl Yield {
    /// `tan(w u / 2) / w` with `w^2 = -D`, or `tanh(d u / 2) / d` with `d^2 = D`: `D = a^2 + 4 b`.
    fn tangent(&self, u: f64) -> f64 {
        let discriminant = self.linear * self.linear + 4.0 * self.quadratic;
        let root = discriminant.abs().sqrt();
        let half = 0.5 * root * u;
        if half < SMALL {
            return 0.5 * u;
        }
        match discriminant > 0.0 {
            true => half.tanh() / root,
            false => half.tan() / root,
        }
    }

    /// From `z` after `u`: with `t` as above, `z + (1 - a z - b z^2) 2 t / (1 + (a + 2 b z) t)`.
    fn after(&self, z: f64, u: f64) -> f64 {
        let t = self.tangent(u);
        let slope = 1.0 - (self.linear + self.quadratic * z) * z;
        z + slope * 2.0 * t / (1.0 + (self.linear + 2.0 * self.quadratic * z) * t)
    }

    /// Distance from `z < 0` to 0.
    fn way_to_zero(&self, z: f64) -> f64 {
        let discriminant = self.linear * self.linear + 4.0 * self.quadratic;
        let root = discriminant.abs().sqrt();
        let t = -z / (2.0 - self.linear * z);
        if root * t < SMALL {
            return 2.0 * t;
        }
        match discriminant > 0.0 {
            true => 2.0 * (root * t).atanh() / root,
            false => 2.0 * (root * t).atan() / root,
        }
    }
}

/// A deformation whose square is not yet zero in floating point.
const SMALLEST: f64 = 1e-100;
/// Arguments below which the tangent equals its argument in floating point.
const SMALL: f64 = 1e-9;

impl BoucWen {
    /// `dz/dx = 1 - (beta sign(x') + gamma sign(z)) z |z|^(n - 1)`, exact for a step in one direction: at most
    /// two pieces, from the present value to 0 and onwards.
    fn hysteretic(&self, x: f64, memory: &Memory) -> f64 {
        let travel = x - memory.position;
        let (sense, travel) = (travel.signum(), travel.abs());
        let z = sense * memory.state;
        if z >= 0.0 {
            return sense * self.growing.after(z, travel);
        }
        let to_zero = self.shrinking.way_to_zero(z);
        sense
            * match travel <= to_zero {
                true => self.shrinking.after(z, travel),
                false => self.growing.after(0.0, travel - to_zero),
            }
    }
}

impl Force for BoucWen {
    fn force(&self, motion: &Motion, x: f64, _v: f64, memory: &Memory) -> f64 {
        motion.stiffness * self.share * (self.hysteretic(x, memory) - x)
    }

    fn advance(&self, _motion: &Motion, x: f64, _v: f64, memory: &Memory) -> f64 {
        self.hysteretic(x, memory)
    }

    fn switch(&self, _motion: &Motion, _x: f64, v: f64, _memory: &Memory) -> Option<f64> {
        (self.share > 0.0).then_some(v)
    }
}

/// A share of the spring yields: `F = k ((1 - a) x + a z)` with Bouc and Wen's `z`.
pub const HYSTERETIC_STIFFNESS: Effect = Effect {
    name: "hysteretic_stiffness",
    title: "hysteretic stiffness",
    places: &[Place::Transmission],
    physics: "A share a of the spring yields: F = k ((1 - a) x + a z), dz/dx = 1 - (beta sign x' + gamma \
        sign z) z |z|^(n - 1). The slope falls from k to (1 - a) k over the deformation x_y, where the \
        hysteretic part ends: (beta + gamma) x_y^n = 1. It unloads with another curve, which makes a \
        loop. `unloading` is (beta - gamma) / (beta + gamma): 0 for a straight unloading, 1 for Dahl's \
        loop; below 0 the loop would create energy. `sharpness` s mixes the exponents n = 1 (s = 0) and 2 (s \
        = 1): dz/dx = 1 - (1 - s) z / x_y - s (z / x_y)^2 while it grows; the larger, the longer the spring \
        stays straight. \
        Source: Bouc, Proc. 4th Conf. Nonlinear Oscillation (1967); Wen, ASCE J. Engineering \
        Mechanics 102 (1976); Erlicher and Point, C. R. Mecanique 332 (2004).",
    remedy: "Expect the position to depend on the way it was reached; approach from one side, or \
        model the loop.",
    parameters: &[
        Parameter {
            name: "share",
            role: ParameterRole::Size,
            quantity: Quantity::NUMBER,
            bounds: |_| (0.0, 0.98),
            neutral: 0.0,
            typical: |_| 0.2,
        },
        Parameter {
            name: "yield_deformation",
            role: ParameterRole::Shape,
            quantity: Quantity::POSITION,
            bounds: |scales| (0.01 * scales.deformation, 5.0 * scales.deformation),
            neutral: 1.0,
            typical: |scales| 0.3 * scales.deformation,
        },
        Parameter {
            name: "unloading",
            role: ParameterRole::Shape,
            quantity: Quantity::NUMBER,
            bounds: |_| (0.0, 3.0),
            neutral: 0.0,
            typical: |_| 0.3,
        },
        Parameter {
            name: "sharpness",
            role: ParameterRole::Shape,
            quantity: Quantity::NUMBER,
            bounds: |_| (0.0, 1.0),
            neutral: 0.0,
            typical: |_| 0.5,
        },
    ],
    properties: &[
        // Dahl's bristles beside a spring are Bouc and Wen's loop with unloading 1 and sharpness 0.
        Property::Includes(&PRESLIDING_HYSTERESIS),
        Property::Alike(Likeness::LowSpeed),
        Property::Slot(Slot::Hysteresis),
    ],
    law: |p| {
        let rate = 1.0 / p[1].max(SMALLEST);
        let (linear, quadratic) = (rate * (1.0 - p[3]), rate * rate * p[3]);
        Law::Force(Box::new(BoucWen {
            share: p[0],
            growing: Yield { linear, quadratic },
            // Against |z|^2 instead of z |z|: the sign of its square is the other.
            shrinking: Yield {
                linear: p[2] * linear,
                quadratic: -p[2] * quadratic,
            },
        }))
    },
    starts: |scales| {
        let yields = [0.05, 0.2, 0.6, 1.5].map(|size| size * scales.deformation);
        let mut starts = product(&[&[0.1, 0.4], &yields, &[0.2], &[0.0]]);
        starts.extend(product(&[&[0.2], &yields, &[1.0], &[0.0]]));
        starts.extend(product(&[&[0.2], &yields, &[0.4], &[1.0]]));
        starts
    },
};

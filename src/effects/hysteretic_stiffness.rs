//! A spring with a hysteresis loop after Bouc and Wen.

use super::grid::product;
use super::{Effect, Force, Law, Memory, Motion, Parameter, Place, Quantity};

struct BoucWen {
    share: f64,
    /// `beta + gamma` and `beta - gamma`: rates at which the hysteretic part yields while it grows
    /// and while it shrinks.
    growing: f64,
    shrinking: f64,
}

/// Solution of `dz/du = 1 - r z` from `z` after `u`.
fn relax(z: f64, u: f64, r: f64) -> f64 {
    let reach = if r == 0.0 { u } else { -(-r * u).exp_m1() / r };
    z + (1.0 - r * z) * reach
}

impl BoucWen {
    /// `dz/dx = 1 - (beta sign(x') + gamma sign(z)) z`, exact for a step in one direction: at most
    /// two exponentials, from the present value to 0 and on.
    fn hysteretic(&self, x: f64, memory: &Memory) -> f64 {
        let travel = x - memory.position;
        let (sense, travel) = (travel.signum(), travel.abs());
        let z = sense * memory.state;
        if z >= 0.0 {
            return sense * relax(z, travel, self.growing);
        }
        let to_zero = match self.shrinking == 0.0 {
            true => -z,
            false => (-self.shrinking * z).ln_1p() / self.shrinking,
        };
        sense
            * match travel <= to_zero {
                true => relax(z, travel, self.shrinking),
                false => relax(0.0, travel - to_zero, self.growing),
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
    places: &[Place::Transmission],
    physics: "A share a of the spring yields: F = k ((1 - a) x + a z), dz/dx = 1 - (beta sign x' + gamma \
        sign z) z. The slope falls from k to (1 - a) k over the deformation x_y = 1 / (beta + gamma), \
        and unloads with another curve, which makes a loop. `unloading` is (beta - gamma) / (beta + \
        gamma): 0 for a straight unloading, 1 for Dahl's loop; below 0 the loop would create energy. \
        Source: Bouc, Proc. 4th Conf. Nonlinear Oscillation (1967); Wen, ASCE J. Engineering \
        Mechanics 102 (1976); Erlicher and Point, C. R. Mecanique 332 (2004).",
    parameters: &[
        Parameter {
            name: "share",
            quantity: Quantity::NUMBER,
            bounds: |_| (0.0, 0.98),
            neutral: 0.0,
            typical: |_| 0.2,
        },
        Parameter {
            name: "yield_deformation",
            quantity: Quantity::POSITION,
            bounds: |scales| (0.01 * scales.deformation, 5.0 * scales.deformation),
            neutral: 1.0,
            typical: |scales| 0.3 * scales.deformation,
        },
        Parameter {
            name: "unloading",
            quantity: Quantity::NUMBER,
            bounds: |_| (0.0, 3.0),
            neutral: 0.0,
            typical: |_| 0.3,
        },
    ],
    law: |p| {
        let growing = 1.0 / p[1].max(f64::MIN_POSITIVE);
        Law::Force(Box::new(BoucWen {
            share: p[0],
            growing,
            shrinking: p[2] * growing,
        }))
    },
    starts: |scales| {
        let yields = [0.05, 0.2, 0.6, 1.5].map(|size| size * scales.deformation);
        let mut starts = product(&[&[0.1, 0.4], &yields, &[0.2]]);
        starts.extend(product(&[&[0.2], &yields, &[1.0]]));
        starts
    },
};

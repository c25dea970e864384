//! Backlash: free play with lift-off.

use super::grid::sizes;
use super::{Effect, Force, Law, Memory, Motion, Parameter, Place, Quantity};

struct Backlash {
    half_gap: f64,
}

impl Force for Backlash {
    /// What the model's spring and damper did is taken away; a flank pushes and never pulls.
    fn force(&self, motion: &Motion, x: f64, v: f64, _memory: &Memory) -> f64 {
        if self.half_gap == 0.0 {
            return 0.0;
        }
        let (k, c, b) = (motion.stiffness, motion.damping, self.half_gap);
        let contact = if x > b {
            (k * (x - b) + c * v).max(0.0)
        } else if x < -b {
            (k * (x + b) + c * v).min(0.0)
        } else {
            0.0
        };
        contact - (k * x + c * v)
    }

    fn switch(&self, x: f64, _v: f64) -> Option<f64> {
        (self.half_gap > 0.0).then(|| x.abs() - self.half_gap)
    }
}

/// Free play of width `gap`: no force inside, spring and damper beyond, `k (|x| - gap / 2) + c |x|'`
/// where that pushes.
pub const BACKLASH: Effect = Effect {
    name: "backlash",
    places: &[Place::Transmission],
    physics: "Teeth have play: inside the gap the link is free, neither elastic nor damping force acts. \
        At a flank spring and damper act again, and the flank lifts off when their sum would pull. \
        Small vibration is slower than large, and the link knocks at reversals. Source: Nordin and \
        Gutman, Automatica 38 (2002).",
    parameters: &[Parameter {
        name: "gap",
        quantity: Quantity::POSITION,
        bounds: |scales| (0.0, 4.0 * scales.deformation),
        neutral: 0.0,
        typical: |scales| 0.1 * scales.deformation,
    }],
    law: |p| {
        Law::Force(Box::new(Backlash {
            half_gap: 0.5 * p[0],
        }))
    },
    // Dense: the misfit has many minima over the gap.
    starts: |scales| {
        sizes(
            scales.deformation,
            [
                0.003, 0.006, 0.012, 0.02, 0.035, 0.06, 0.1, 0.17, 0.3, 0.5, 0.85, 1.5,
            ],
        )
    },
};

//! Backlash: free play with lift-off.

use super::grid::sizes;
use super::{Effect, Force, Law, Memory, Motion, Parameter, Place, Quantity};

struct Backlash {
    half_gap: f64,
}

impl Backlash {
    /// How deep a flank is in contact, and its force as a deformation where that is above 0.
    fn contact(&self, side: f64, motion: &Motion, x: f64, v: f64) -> [f64; 2] {
        let depth = side * x - self.half_gap;
        [depth, depth + motion.damping / motion.stiffness * side * v]
    }
}

impl Force for Backlash {
    /// What the model's spring and damper did is taken away; a flank pushes and never pulls.
    fn force(&self, motion: &Motion, x: f64, v: f64, memory: &Memory) -> f64 {
        let side = memory.state;
        let linear = motion.stiffness * x + motion.damping * v;
        if self.half_gap == 0.0 {
            0.0
        } else if side == 0.0 {
            -linear
        } else {
            side * motion.stiffness * self.contact(side, motion, x, v)[1] - linear
        }
    }

    /// Which flank pushes: 1, -1 or, inside the gap and after a lift-off, 0.
    fn advance(&self, motion: &Motion, x: f64, v: f64, _memory: &Memory) -> f64 {
        let [depth, push] = self.contact(x.signum(), motion, x, v);
        match depth > 0.0 && push > 0.0 {
            true => x.signum(),
            false => 0.0,
        }
    }

    /// Above 0 while a flank pushes: it meets at the gap's edge and lifts off where its force is gone.
    fn switch(&self, motion: &Motion, x: f64, v: f64, memory: &Memory) -> Option<f64> {
        let switch = match memory.state {
            0.0 => {
                let [depth, push] = self.contact(x.signum(), motion, x, v);
                depth.min(push)
            }
            side => self.contact(side, motion, x, v)[1],
        };
        (self.half_gap > 0.0).then_some(switch)
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

//! Backlash: free play with lift-off.

use super::grid::product;
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

struct Backlash {
    half_gap: f64,
    /// Share of the damper that acts without contact.
    film: f64,
}

impl Backlash {
    /// Depth of a flank's contact, and its force as a deformation where that is positive.
    fn contact(&self, side: f64, motion: &Motion, x: f64, v: f64) -> [f64; 2] {
        let depth = side * x - self.half_gap;
        let damper = (1.0 - self.film) * motion.damping / motion.stiffness;
        [depth, depth + damper * side * v]
    }
}

impl Force for Backlash {
    /// The force of the model's spring and damper is subtracted; a flank pushes and never pulls.
    fn force(&self, motion: &Motion, x: f64, v: f64, memory: &Memory) -> f64 {
        let side = memory.state;
        let lost = motion.stiffness * x + (1.0 - self.film) * motion.damping * v;
        if self.half_gap == 0.0 {
            0.0
        } else if side == 0.0 {
            -lost
        } else {
            side * motion.stiffness * self.contact(side, motion, x, v)[1] - lost
        }
    }

    /// The flank that pushes: 1, -1 or, inside the gap and after a lift-off, 0.
    fn advance(&self, motion: &Motion, x: f64, v: f64, _memory: &Memory) -> f64 {
        let [depth, push] = self.contact(x.signum(), motion, x, v);
        match depth > 0.0 && push > 0.0 {
            true => x.signum(),
            false => 0.0,
        }
    }

    /// Positive while a flank pushes: contact begins at the gap's edge and ends where the force vanishes.
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

/// Free play of width `gap`: no elastic force inside, `k (|x| - gap / 2) + (1 - s) c |x|'` beyond, where
/// that pushes, and `s c x'` everywhere, with `s` the share of the damper that acts in the gap, too.
pub const BACKLASH: Effect = Effect {
    name: "backlash",
    title: "backlash",
    places: &[Place::Transmission],
    physics: "Teeth have play: inside the gap the spring does not act, and of the damper only what does \
        not need contact, the oil between the flanks (`damping_in_gap` times the damper). At a flank \
        spring and damper act again, and the flank lifts off when their sum would pull. Small vibration \
        is slower than large, and the link knocks at reversals. Source: Nordin and Gutman, Automatica \
        38 (2002), which has both the dead zone with a damper beside it and the one with the damper \
        behind the gap.",
    remedy: "Check gear play, couplings and loose screws; preload the gear, or keep the load from \
        changing sign.",
    parameters: &[
        Parameter {
            name: "gap",
            role: ParameterRole::Size,
            quantity: Quantity::POSITION,
            bounds: |scales| (0.0, 4.0 * scales.deformation),
            neutral: 0.0,
            typical: |scales| 0.1 * scales.deformation,
        },
        Parameter {
            name: "damping_in_gap",
            role: ParameterRole::Shape,
            quantity: Quantity::NUMBER,
            bounds: |_| (0.0, 1.0),
            neutral: 0.0,
            typical: |_| 1.0,
        },
    ],
    properties: &[
        Property::ManyMinima,
        Property::Optional("damping_in_gap"),
        Property::Slot(Slot::Spring),
    ],
    law: |p| {
        Law::Force(Box::new(Backlash {
            half_gap: 0.5 * p[0],
            film: p[1],
        }))
    },
    starts: |scales| {
        // Dense, and the smallest first, since the misfit has many minima over the gap.
        let gaps = [
            5e-4, 0.001, 0.002, 0.004, 0.008, 0.015, 0.025, 0.04, 0.065, 0.1, 0.17, 0.3, 0.5, 0.85,
            1.5,
        ];
        let gaps = gaps.map(|size| size * scales.deformation);
        product(&[&gaps, &[0.0]])
    },
};

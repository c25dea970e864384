//! An end stop.

use super::grid::{product, reach, typical_position};
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

/// Number of candidate instants of a contact that are tried.
const CANDIDATES: usize = 3;

struct EndStop {
    stiffness: f64,
    position: f64,
    /// Damping over stiffness, s.
    time_constant: f64,
    /// Damping that grows with the depth, over stiffness, s per position.
    dissipation: f64,
    /// 1 for a stop above the range of motion, -1 for one below it.
    side: f64,
}

impl EndStop {
    /// Depth, and the force's share of the stiffness where that is above 0.
    fn contact(&self, x: f64, v: f64) -> [f64; 2] {
        let depth = self.side * (x - self.position);
        let deeper = self.side * v;
        [
            depth,
            depth * (1.0 + self.dissipation * deeper) + self.time_constant * deeper,
        ]
    }
}

impl Force for EndStop {
    fn force(&self, _motion: &Motion, x: f64, v: f64, memory: &Memory) -> f64 {
        match self.stiffness == 0.0 || memory.state == 0.0 {
            true => 0.0,
            false => self.side * self.stiffness * self.contact(x, v)[1],
        }
    }

    /// 1 in contact, 0 else.
    fn advance(&self, _motion: &Motion, x: f64, v: f64, _memory: &Memory) -> f64 {
        let [depth, push] = self.contact(x, v);
        f64::from(u8::from(depth > 0.0 && push > 0.0))
    }

    fn stiffness(&self, _v: f64, memory: &Memory) -> f64 {
        memory.state * self.stiffness
    }

    /// Positive in contact, which begins where the depth vanishes and ends where the force vanishes.
    fn switch(&self, _motion: &Motion, x: f64, v: f64, memory: &Memory) -> Option<f64> {
        let [depth, push] = self.contact(x, v);
        let switch = if memory.state == 0.0 {
            depth.min(push)
        } else {
            push
        };
        (self.stiffness > 0.0).then_some(switch)
    }
}

/// One-sided contact: `F = k max(e (1 + d e') + T e', 0)` at a depth `e > 0` beyond the stop.
pub const END_STOP: Effect = Effect {
    name: "end_stop",
    title: "end stop",
    places: &[Place::Link],
    physics: "Beyond a position the link meets a bumper that pushes with k (e (1 + d e') + T e'), e the depth, and \
        never pulls: it comes off when that is negative. `side` above 0 is a stop above the range of motion, below 0 \
        one below it. What a bumper loses grows with the depth (d, s per unit of position; Hunt and Crossley), as where \
        bodies touch at a point, or does not (T = c / k; Kelvin and Voigt), as of a damper behind a plate. Source: Hunt and \
        Crossley, ASME J. Applied Mechanics 42 (1975); Brogliato, Nonsmooth Mechanics (2016), chapter 2.",
    remedy: "Keep clear of the stop, or look for a cable that tightens there.",
    parameters: &[
        Parameter {
            name: "stiffness",
            role: ParameterRole::Size,
            quantity: Quantity::new(1, -1, 0),
            // A link on a stiffer one vibrates at more than ten times the joint's frequency: that stop is rigid.
            bounds: |scales| (0.0, 100.0 * scales.force / scales.deformation),
            neutral: 0.0,
            typical: |scales| scales.force / scales.deformation,
        },
        Parameter {
            name: "position",
            role: ParameterRole::Border,
            quantity: Quantity::POSITION,
            bounds: |scales| {
                let margin = 1.05 * reach(scales) - scales.travel();
                (scales.position.0 - margin, scales.position.1 + margin)
            },
            neutral: 0.0,
            typical: typical_position,
        },
        Parameter {
            name: "time_constant",
            role: ParameterRole::Shape,
            quantity: Quantity::TIME,
            bounds: |scales| (0.0, 0.1 * scales.period()),
            neutral: 0.0,
            typical: |scales| 0.02 * scales.period(),
        },
        Parameter {
            name: "dissipation",
            role: ParameterRole::Shape,
            quantity: Quantity::new(0, -1, 1),
            // An impact with a speed v leaves 1 - 2/3 d v of it (Hunt and Crossley): beyond this bound even a twentieth of the
            // axis' speed leaves nothing.
            bounds: |scales| (0.0, 30.0 / scales.velocity),
            neutral: 0.0,
            typical: |scales| 0.3 / scales.velocity,
        },
        Parameter {
            name: "side",
            role: ParameterRole::Side,
            quantity: Quantity::NUMBER,
            bounds: |_| (-1.0, 1.0),
            neutral: 1.0,
            typical: |_| 1.0,
        },
    ],
    properties: &[Property::Slot(Slot::PositionForce)],
    law: |p| {
        Law::Force(Box::new(EndStop {
            stiffness: p[0],
            position: p[1],
            time_constant: p[2],
            dissipation: p[3],
            side: 1f64.copysign(p[4]),
        }))
    },
    starts: |scales| {
        let stiffness = scales.force / scales.deformation;
        let damping = 0.02 * scales.period();
        let range = reach(scales);
        // Relevant depths are of the size of the deformation or of the range.
        let depths = [
            0.2 * scales.deformation,
            scales.deformation,
            0.02 * range,
            0.08 * range,
            0.25 * range,
        ];
        let start = |depth: f64, side: f64| {
            let depth = depth.min(0.9 * range);
            let end = [scales.position.0, scales.position.1][usize::from(side > 0.0)];
            vec![0.5 * stiffness, end - side * depth, damping, 0.0, side]
        };
        let ends = [-1.0, 1.0].into_iter();
        let ends = ends.flat_map(|side| depths.map(|depth| start(depth, side)));
        // Or the link met the stop at a candidate event.
        let met = scales.candidate_stops.iter().take(CANDIDATES);
        let met = met.flat_map(|candidate| {
            // A start with a somewhat earlier or harder contact leads to the optimum; a start without contact
            // does not. The link may run into the stop, or touch it where it turns back.
            let inside = |from: f64, share: f64| {
                let depth = share * scales.deformation;
                (from - candidate.side * depth).clamp(scales.position.0, scales.position.1)
            };
            let met = [0.0, 0.3, 1.0].map(|share| inside(candidate.position, share));
            let touched = [0.01, 0.03, 0.1].map(|share| inside(candidate.farthest, share));
            let start = |sizes: &[f64], positions: &[f64]| {
                product(&[sizes, positions, &[damping], &[0.0], &[candidate.side]])
            };
            let sizes = [0.3, 2.0, 6.0].map(|size| size * stiffness);
            [start(&sizes, &met), start(&sizes[1..2], &touched)].concat()
        });
        ends.chain(met).collect()
    },
};

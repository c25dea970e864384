//! A sensor clock with a wrong rate.

use super::grid::sizes;
use super::{
    Effect, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Scales, Sensor,
    Slot,
};

struct Skew {
    skew: f64,
}

impl Sensor for Skew {
    fn instant(&self, time: f64) -> f64 {
        time + self.skew * time
    }
}

/// The stamp `t` marks the motion at `t + s t`.
pub const CLOCK_SKEW: Effect = Effect {
    name: "clock_skew",
    title: "clock skew",
    places: &[Place::Sensor],
    physics: "Two quartzes differ by up to 1e-4, and by 1e-3 where one is a timer in software: the stamp t \
        stands on what was at (1 + s) t. The error grows with time and follows the speed. It turns \
        about the time 0; an offset of the clock moves that point. Source: Moon, Skelly, Towsley, \
        Estimation and removal of clock skew from network delay measurements, IEEE INFOCOM (1999).",
    remedy: "Give both devices one clock, or stretch one recording's time by the skew.",
    parameters: &[Parameter {
        name: "skew",
        role: ParameterRole::Size,
        quantity: Quantity::NUMBER,
        bounds: |_| (-0.1, 0.1),
        neutral: 0.0,
        typical: |scales| 0.3 * shift_of_deformation(scales),
    }],
    properties: &[
        Property::Alike(Likeness::ShiftInTime),
        Property::Slot(Slot::Clock),
    ],
    law: |p| Law::Sensor(Box::new(Skew { skew: p[0] })),
    starts: |scales| sizes(shift_of_deformation(scales), [-0.3, 0.3]),
};

/// The skew whose error at the end is as large as the deformation: relevant, and still linear.
fn shift_of_deformation(scales: &Scales) -> f64 {
    (scales.deformation / (scales.velocity * scales.duration())).min(0.05)
}

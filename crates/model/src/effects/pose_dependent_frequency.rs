//! A link whose inertia, or a transmission whose stiffness, depends on the pose.

use super::grid::{product, reach, typical_position};
use super::{
    Effect, Inertia, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

/// Least factor on the inertia: it stays positive where the law does not.
const LEAST: f64 = 0.1;

/// A wave about an extremum; a parabola in the limit of order 0.
struct Wave {
    curvature: f64,
    centre: f64,
    coupling: f64,
    order: f64,
}

impl Inertia for Wave {
    fn factor(&self, _time: f64, position: f64) -> f64 {
        let distance = position - self.centre;
        let chord = distance * sinc(0.5 * self.order * distance);
        (1.0 + self.curvature * chord * chord).max(LEAST)
    }

    fn slope(&self, time: f64, position: f64) -> f64 {
        let distance = position - self.centre;
        match self.factor(time, position) > LEAST {
            true => 2.0 * self.coupling * self.curvature * distance * sinc(self.order * distance),
            false => 0.0,
        }
    }
}

/// `sin x / x`.
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.sin() / x }
}

/// Inertia over stiffness relative to the nominal one: `m = 1 + 2 a (1 - cos k (y - y_0)) / k^2`, at least 0.1,
/// in `m y'' + c m' y'^2 / 2 = F`; `k` is the order. With `k = 0` it is `1 + a (y - y_0)^2`.
pub const POSE_DEPENDENT_FREQUENCY: Effect = Effect {
    name: "pose_dependent_frequency",
    title: "pose-dependent frequency",
    places: &[Place::Link],
    physics: "An arm that reaches out has more inertia than one that is folded, and vibrates more \
        slowly: m = 1 + 2 a (1 - cos k (y - y_0)) / k^2. The order k is 1 where an arm folds, J = J_1 + J_2 + 2 m l_1 \
        l_2 cos q_2, and 2 where a body turns about an axis that is none of its principal ones. With k = 0 it is m \
        = 1 + a (y - y_0)^2, the law of a mass that moves along a radius. For a small range all are alike, and y_0 \
        is an extremum within or far off. A varying inertia also couples the velocity, c m' y'^2 / 2 with c = 1. \
        Of a belt or a ball screw between two bearings it is the compliance that is a parabola over the position, \
        x (L - x) / (E A L), and nothing couples: c = 0. \
        Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), \
        chapter 7; Altintas, Verl, Brecher, Uriarte, Pritschow, Machine tool feed drives, CIRP Annals 60 (2011).",
    remedy: "Take the frequency by pose: shape for the pose at the end of the move.",
    parameters: &[
        Parameter {
            name: "curvature",
            role: ParameterRole::Size,
            quantity: Quantity::new(0, -2, 0),
            bounds: |scales| {
                let unit = reach(scales).powi(-2);
                (-3.6 * unit, 20.0 * unit)
            },
            neutral: 0.0,
            typical: |scales| 0.3 * reach(scales).powi(-2),
        },
        Parameter {
            name: "centre",
            role: ParameterRole::Position,
            quantity: Quantity::POSITION,
            bounds: |scales| {
                let reach = reach(scales);
                (
                    scales.position.0 - 3.0 * reach,
                    scales.position.1 + 3.0 * reach,
                )
            },
            neutral: 0.0,
            typical: typical_position,
        },
        Parameter {
            name: "coupling",
            role: ParameterRole::Shape,
            quantity: Quantity::NUMBER,
            // From a varying stiffness to a varying inertia.
            bounds: |_| (0.0, 1.0),
            neutral: 0.0,
            typical: |_| 1.0,
        },
        Parameter {
            name: "order",
            role: ParameterRole::Shape,
            quantity: Quantity::new(0, -1, 0),
            // Rotation of a rigid body has no order above 2.
            bounds: |_| (0.0, 3.0),
            neutral: 0.0,
            typical: |_| 1.0,
        },
    ],
    properties: &[
        Property::Optional("order"),
        Property::Alike(Likeness::Pose),
        Property::Slot(Slot::Inertia),
    ],
    law: |p| {
        Law::Inertia(Box::new(Wave {
            curvature: p[0],
            centre: p[1],
            coupling: p[2],
            order: p[3],
        }))
    },
    starts: |scales| {
        let reach = reach(scales);
        // Inside the range, at its ends and outside; the size is the change over the range. An arm that folds, and a
        // compliance.
        let centres = [-1.0, 0.0, 0.5, 1.0, 2.0];
        let start = |row: Vec<f64>| {
            let farthest = row[1].abs().max((1.0 - row[1]).abs()) * reach;
            let centre = scales.position.0 + row[1] * reach;
            vec![row[0] * farthest.powi(-2), centre, row[2], row[3]]
        };
        let mut rows = product(&[&[-0.2, 0.15, 0.8], &centres, &[1.0], &[1.0]]);
        rows.extend(product(&[&[-0.2, 0.4], &[-1.0, 0.5, 2.0], &[0.0], &[0.0]]));
        rows.into_iter().map(start).collect()
    },
};

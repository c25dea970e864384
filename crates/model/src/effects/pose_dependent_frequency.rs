//! A link whose inertia, or a transmission whose stiffness, depends on the pose.

use super::grid::{product, reach, typical_position};
use super::{
    Effect, Inertia, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Slot,
};

/// Least factor on the inertia: it stays positive where the parabola does not.
const LEAST: f64 = 0.1;

struct Parabola {
    curvature: f64,
    centre: f64,
    coupling: f64,
}

impl Inertia for Parabola {
    fn factor(&self, _time: f64, position: f64) -> f64 {
        (1.0 + self.curvature * (position - self.centre).powi(2)).max(LEAST)
    }

    fn slope(&self, time: f64, position: f64) -> f64 {
        match self.factor(time, position) > LEAST {
            true => 2.0 * self.coupling * self.curvature * (position - self.centre),
            false => 0.0,
        }
    }
}

/// Inertia over stiffness relative to the nominal one: `m = 1 + a (y - y_0)^2`, at least 0.1, in
/// `m y'' + c m' y'^2 / 2 = F`.
pub const POSE_DEPENDENT_FREQUENCY: Effect = Effect {
    name: "pose_dependent_frequency",
    title: "pose-dependent frequency",
    places: &[Place::Link],
    physics: "An arm that reaches out has more inertia than one that is folded, and vibrates more \
        slowly: m = 1 + a (y - y_0)^2, the law of a mass that moves along a radius and, for a small \
        range, of any smooth one (an extremum within, a slope with y_0 far off). A varying inertia \
        also couples the velocity, c m' y'^2 / 2 with c = 1. Of a belt or a ball screw between two bearings it \
        is the compliance that is a parabola over the position, x (L - x) / (E A L), and nothing couples: c = 0. \
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
    ],
    properties: &[
        Property::Alike(Likeness::Pose),
        Property::Slot(Slot::Inertia),
    ],
    law: |p| {
        Law::Inertia(Box::new(Parabola {
            curvature: p[0],
            centre: p[1],
            coupling: p[2],
        }))
    },
    starts: |scales| {
        let reach = reach(scales);
        // Inside the range, at its ends and outside; the size is the change over the range.
        let centres = [-1.0, 0.0, 0.5, 1.0, 2.0];
        let start = |row: Vec<f64>| {
            let farthest = row[1].abs().max((1.0 - row[1]).abs()) * reach;
            let centre = scales.position.0 + row[1] * reach;
            vec![row[0] * farthest.powi(-2), centre, row[2]]
        };
        let mut rows = product(&[&[-0.2, 0.15, 0.8], &centres, &[1.0]]);
        rows.extend(product(&[&[-0.2, 0.4], &[-1.0, 0.5, 2.0], &[0.0]]));
        rows.into_iter().map(start).collect()
    },
};

//! Damping of any shape over the position.

use super::learned::{FINER, PARAMETERS, ordinate, over_position, parameters, spline, split};
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, Place, Property, Quantity, Slot, Spline,
};

struct OverPosition {
    curve: Spline,
    /// Ends of the range, where the slope jumps.
    corners: Option<(f64, f64)>,
}

impl Force for OverPosition {
    fn force(&self, _motion: &Motion, x: f64, v: f64, _memory: &Memory) -> f64 {
        // A damper never drives.
        self.curve.nearest(x).max(0.0) * v
    }

    fn switch(&self, _motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> Option<f64> {
        self.corners.map(|(from, to)| (x - from) * (x - to))
    }
}

/// Damping that depends on the position of the axis, beside that of the model: `F = c(x) v`.
pub const LEARNED_POSITION_DAMPING: Effect = Effect {
    parameters: &parameters::<PARAMETERS>(ORDINATE, Quantity::POSITION),
    properties: &[
        Property::Slot(Slot::PositionDamping),
        Property::Finer(&FINE),
    ],
    starts: over_position::<PARAMETERS>,
    ..FINE
};

/// The same with finer knots: what a detent or a pocket in a guide does within a small part of the travel.
const FINE: Effect = Effect {
    name: "learned_position_damping",
    title: "learned damping over position",
    places: &[Place::Drive, Place::Link],
    physics: "A force c(x) v resists motion, more at some positions than at others: a guide that is tight or dry \
        there, a seal, an eddy-current brake, a cushion of air. The coefficient is learned: a cubic spline through its \
        values at equally spaced positions, constant outside of what was visited, and nowhere below 0. Source: Armstrong-Helouvry, \
        Control of Machines with Friction (1991), chapter 4, for friction over the position; de Boor, A Practical Guide to Splines (1978).",
    remedy: "Look at the guide where the curve is high; add the curve to the feedforward of friction.",
    law: |p| {
        let ((_, from, to), curve) = (split(p), spline(p));
        let has_corners = [from, to].iter().any(|end| curve.slope(*end) != 0.0);
        Law::Force(Box::new(OverPosition {
            curve,
            corners: has_corners.then_some((from, to)),
        }))
    },
    parameters: &parameters::<FINER>(ORDINATE, Quantity::POSITION),
    properties: &[Property::Slot(Slot::PositionDamping)],
    starts: over_position::<FINER>,
};

const ORDINATE: Parameter = ordinate(
    Quantity::new(1, -1, 1),
    |scales| (0.0, 20.0 * scales.force / scales.velocity),
    |scales| 0.05 * scales.force / scales.velocity,
);

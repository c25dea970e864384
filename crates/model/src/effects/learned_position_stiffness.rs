//! Stiffness that depends on the position of the drive in any way.

use super::learned::{PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Force, Law, Memory, Motion, Place, Property, Quantity, Slot, Spline};

/// Least relative change: the spring stays one between its knots.
const SOFTEST: f64 = -0.95;

struct OverPosition(Spline);

impl Force for OverPosition {
    fn force(&self, motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        motion.stiffness * self.0.not_less(motion.motor[0]).max(SOFTEST) * x
    }
}

/// Stiffness that depends on the position of the motor side: `F = k f(u) x`, beside that of the model's spring.
pub const LEARNED_POSITION_STIFFNESS: Effect = Effect {
    name: "learned_position_stiffness",
    title: "learned stiffness over position",
    places: &[Place::Transmission],
    physics: "The stiffness is k (1 + f(u)) at the position u of the motor side: a ball screw or a belt is softer far from its \
        bearings, a gear has teeth or bolts that carry less, a cable has another free length. The inertia does not change, \
        so that nothing couples the velocity. The curve is learned: a cubic spline through its values at equally spaced \
        positions, outside of what was visited of constant slope where it rises, else constant. Source: Altintas, Verl, \
        Brecher, Uriarte, Pritschow, Machine tool feed drives, CIRP Annals 60 (2011); de Boor, A Practical Guide to Splines \
        (1978).",
    remedy: "Take the frequency by pose: shape for the pose at the end of the move.",
    parameters: &parameters::<PARAMETERS>(
        ordinate(Quantity::NUMBER, |_| (-0.9, 5.0), |_| 0.1),
        Quantity::POSITION,
    ),
    properties: &[Property::Slot(Slot::JointStiffness)],
    law: |p| Law::Force(Box::new(OverPosition(spline(p)))),
    starts: |scales| vec![start::<PARAMETERS>(scales.visited_motor_position())],
};

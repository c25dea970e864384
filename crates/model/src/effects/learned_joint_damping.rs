//! Damping across the joint, of any shape over the position.

use super::learned::{FINER, PARAMETERS, parameters, spline, start};
use super::learned_damping::{COEFFICIENT, beside};
use super::{Effect, Force, Law, Memory, Motion, Place, Property, Quantity, Slot, Spline};

struct OverMotor(Spline);

impl Force for OverMotor {
    fn force(&self, motion: &Motion, _x: f64, v: f64, _memory: &Memory) -> f64 {
        beside(motion, self.0.nearest(motion.motor[0])) * v
    }
}

/// Damping across the joint that depends on the position of the motor side, beside that of the model's damper: `F = c(u) x'`.
pub const LEARNED_JOINT_DAMPING: Effect = Effect {
    parameters: &parameters::<PARAMETERS>(COEFFICIENT, Quantity::POSITION),
    properties: &[Property::Slot(Slot::JointDamping), Property::Finer(&FINE)],
    starts: |scales| vec![start::<PARAMETERS>(scales.visited_motor_position())],
    ..FINE
};

/// The same with finer knots, for a few teeth or one belt's joint.
const FINE: Effect = Effect {
    name: "learned_joint_damping",
    title: "learned damping over the motor side's position",
    places: &[Place::Transmission],
    physics: "The damper between motor side and link differs from c by a curve over the position u of the motor side: teeth, \
        rollers or a belt that rub more at one place than at another. The curve is learned: a cubic spline through its values at \
        equally spaced positions, constant outside of what was visited; the whole coefficient is never below 0. Source: \
        Armstrong-Helouvry, Control of Machines with Friction (1991), chapter 4, for friction over the position; de Boor, A \
        Practical Guide to Splines (1978).",
    remedy: "Look at the gear or belt where the curve is high; take the damping of the position where the move ends.",
    parameters: &parameters::<FINER>(COEFFICIENT, Quantity::POSITION),
    properties: &[Property::Slot(Slot::JointDamping)],
    law: |p| Law::Force(Box::new(OverMotor(spline(p)))),
    starts: |scales| vec![start::<FINER>(scales.visited_motor_position())],
};

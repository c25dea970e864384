//! Stiffness that depends on the speed of the drive in any way.

use super::learned::{PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Force, Law, Memory, Motion, Place, Property, Quantity, Slot, Spline};

/// Least relative change: the spring stays one between its knots.
const SOFTEST: f64 = -0.95;

struct OverSpeed(Spline);

impl Force for OverSpeed {
    fn force(&self, motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        motion.stiffness * self.0.not_less(motion.motor[1].abs()).max(SOFTEST) * x
    }
}

/// Stiffness that depends on the speed of the motor side: `F = k f(|w|) x`, beside that of the model's spring.
pub const LEARNED_SPEED_STIFFNESS: Effect = Effect {
    name: "learned_speed_stiffness",
    title: "learned stiffness over speed",
    places: &[Place::Transmission],
    physics: "The stiffness is k (1 + f(|w|)) at the velocity w of the motor side, the same in both directions: rolling contacts share the load otherwise \
        in motion than at rest, a film of oil carries at speed, a belt is tighter as it runs. The curve is learned: a cubic spline \
        through its values at equally spaced speeds, beyond the fastest of constant slope where it rises, else constant. Source: Harris and \
        Kotzalas, Essential Concepts of Bearing Technology (2006), for contacts and films; de Boor, A Practical Guide to Splines (1978).",
    remedy: "Identify the frequency in motion and at rest; shape for that of the end of the move.",
    parameters: &parameters::<PARAMETERS>(
        ordinate(Quantity::NUMBER, |_| (-0.9, 5.0), |_| 0.05),
        Quantity::VELOCITY,
    ),
    properties: &[Property::Slot(Slot::SpeedStiffness)],
    law: |p| Law::Force(Box::new(OverSpeed(spline(p)))),
    starts: |scales| {
        vec![start::<PARAMETERS>((
            0.0,
            scales.visited_motor_velocity().1,
        ))]
    },
};

//! A frequency that depends on the pose in any way.

use super::learned::{PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Inertia, Law, Place, Property, Quantity, Slot, Spline};

/// Least factor on the inertia, which stays positive where the curve does not.
const LEAST: f64 = 0.1;

struct Curve(Spline);

impl Inertia for Curve {
    fn factor(&self, _time: f64, position: f64) -> f64 {
        (1.0 + self.0.value(position)).max(LEAST)
    }

    fn slope(&self, time: f64, position: f64) -> f64 {
        match self.factor(time, position) > LEAST {
            true => self.0.slope(position),
            false => 0.0,
        }
    }
}

/// Inertia relative to the nominal one: `m = 1 + f(y)`, at least 0.1.
pub const LEARNED_FREQUENCY: Effect = Effect {
    name: "learned_frequency",
    title: "learned frequency over the pose",
    places: &[Place::Link],
    physics: "The link's inertia is 1 + f(y) times the nominal one at the position y, so that the frequency changes \
        with 1 / sqrt(1 + f). The curve is learned: a cubic spline through its values at equally spaced positions, \
        of constant slope outside of what was visited. The varying inertia also couples the velocity, m' y'^2 / 2. \
        Source: Siciliano, Sciavicco, Villani, Oriolo, Robotics: Modelling, Planning and Control (2009), chapter 7.",
    remedy: "Take the frequency by pose: shape for the pose at the end of the move.",
    parameters: &parameters::<PARAMETERS>(
        ordinate(Quantity::NUMBER, |_| (-0.9, 20.0), |_| 0.1),
        Quantity::POSITION,
    ),
    properties: &[Property::Slot(Slot::Inertia)],
    law: |p| Law::Inertia(Box::new(Curve(spline(p)))),
    starts: |scales| vec![start::<PARAMETERS>(scales.visited_position())],
};

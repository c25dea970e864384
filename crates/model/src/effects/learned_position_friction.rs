//! Dry friction whose level depends on the position in any way.

use super::coulomb_friction::COULOMB_FRICTION;
use super::learned::{FINER, PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Friction, Law, Parameter, Place, Property, Quantity, Scales, Slot};

/// Dry friction with a level over the position: `F = f(x) sign v`, and it sticks up to `f(x)`.
pub const LEARNED_POSITION_FRICTION: Effect = Effect {
    parameters: &parameters::<PARAMETERS>(ORDINATE, Quantity::POSITION),
    properties: &[
        Property::Slot(Slot::PositionFriction),
        Property::Contains(&COULOMB_FRICTION),
        Property::Finer(&FINE),
    ],
    starts: over_position::<PARAMETERS>,
    ..FINE
};

/// The same with finer knots, as for teeth or rollers.
const FINE: Effect = Effect {
    name: "learned_position_friction",
    title: "learned friction over position",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Two surfaces stick up to a level f(x) and slide against it, more at some positions than at others: a guide that \
        is worn in the middle, a gear whose teeth or rollers load it in turn, a seal that grips. At the transmission x is the \
        position of the motor side. The level is learned: a cubic spline through its values at equally spaced positions, \
        constant outside of what was visited, and nowhere below 0. Source: Armstrong-Helouvry, Control of Machines with Friction \
        (1991), chapter 4; de Boor, A Practical Guide to Splines (1978).",
    remedy: "Look at the guide or gear where the level is high; compensate it by a table over the position.",
    law: |p| Law::Friction(Friction::over_position(spline(p))),
    parameters: &parameters::<FINER>(ORDINATE, Quantity::POSITION),
    properties: &[
        Property::Slot(Slot::PositionFriction),
        Property::Contains(&COULOMB_FRICTION),
    ],
    starts: over_position::<FINER>,
};

const ORDINATE: Parameter = ordinate(
    Quantity::FORCE,
    |scales| (0.0, scales.force),
    |scales| 0.05 * scales.force,
);

/// The position is the link's at the link, and the motor side's elsewhere.
fn over_position<const PARAMETERS: usize>(scales: &Scales) -> Vec<Vec<f64>> {
    let motor = scales.visited_motor_position();
    [motor, motor, scales.visited_position()]
        .map(start::<PARAMETERS>)
        .to_vec()
}

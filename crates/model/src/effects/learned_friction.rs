//! Dry friction of any shape.

use super::learned::{PARAMETERS, ordinate, parameters, split, start};
use super::{Effect, Friction, Law, Parameter, Place, Property, Quantity, Slot, Spline};

/// Dry friction whose level depends on the slip speed in any way, separately in each direction. It sticks up to
/// the level at speed 0, and slides with the level at its speed.
///
/// The first half of the ordinates are the levels of negative slip velocity, from the fastest to 0, the second
/// half those of positive velocity, from 0 to the fastest.
pub const LEARNED_FRICTION: Effect = Effect {
    name: "learned_friction",
    title: "learned friction",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Two surfaces stick until the force between them exceeds the level of friction at rest, and slide \
        against a level that depends on the slip velocity: a curve for each direction, which is learned, with a \
        jump where the velocity changes its sign. Each is a cubic spline through levels at equally spaced speeds, \
        of constant slope beyond the fastest that was visited; no level is below 0, so that friction never \
        drives. Source: Karnopp, ASME J. Dynamic Systems, Measurement and Control 107 (1985); Armstrong-Helouvry, \
        Dupont, Canudas de Wit, Automatica 30 (1994).",
    remedy: "Look at the curve; compensate it by a table over the velocity.",
    parameters: &both_ways(parameters::<PARAMETERS>(
        ordinate(
            Quantity::FORCE,
            |scales| (0.0, scales.force),
            |scales| 0.05 * scales.force,
        ),
        Quantity::VELOCITY,
    )),
    properties: &[Property::Slot(Slot::Friction)],
    law: |p| {
        let (ordinates, from, to) = split(p);
        let (backward, forward) = ordinates.split_at(ordinates.len() / 2);
        let backward: Vec<f64> = backward.iter().rev().copied().collect();
        Law::Friction(Friction::over_speed([
            Spline::new(0.0, to, forward),
            Spline::new(0.0, -from, &backward),
        ]))
    },
    starts: |scales| {
        // Both sides of the axis have the same speed, apart from the vibration.
        let speeds = scales.visited_motor_velocity();
        [speeds, scales.visited_slip(), speeds]
            .map(start::<PARAMETERS>)
            .to_vec()
    },
};

/// The range includes 0, since each direction has its own branch.
const fn both_ways(mut parameters: [Parameter; PARAMETERS]) -> [Parameter; PARAMETERS] {
    parameters[PARAMETERS - 2].bounds = |_| (f64::MIN, 0.0);
    parameters[PARAMETERS - 1].bounds = |_| (0.0, f64::MAX);
    parameters
}

//! Dry friction of any shape.

use super::learned::{FINER, PARAMETERS, ordinate, parameters, split, start};
use super::{Effect, Friction, Law, Parameter, Place, Property, Quantity, Scales, Slot, Spline};

/// Speed `s` of the dense knots, as a share of the fastest that was visited: a simulator's transition from rest to sliding is
/// some thousandth of the fastest speed.
const SLOW: f64 = 1e-4;
/// A velocity of 0 with a direction, as a share of the fastest.
const AT_REST: f64 = 1e-9;

const LEVEL: Parameter = ordinate(
    Quantity::FORCE,
    |scales| (0.0, scales.force),
    |scales| 0.05 * scales.force,
);

/// Dry friction whose level depends on the slip speed in any way, separately in each direction. It sticks up to
/// the level at speed 0, and slides with the level at its speed.
///
/// The first half of the ordinates are the levels of negative slip velocity, from the fastest to 0, the second
/// half those of positive velocity, from 0 to the fastest.
pub const LEARNED_FRICTION: Effect = Effect {
    parameters: &both_ways(parameters::<PARAMETERS>(LEVEL, Quantity::VELOCITY)),
    properties: &[Property::Slot(Slot::Friction), Property::Finer(&FINE)],
    law: |p| {
        let ([backward, forward], from, to) = directions(p);
        Law::Friction(Friction::over_speed([
            Spline::new(0.0, to, &forward),
            Spline::new(0.0, -from, &backward),
        ]))
    },
    starts: neutral::<PARAMETERS>,
    ..FINE
};

/// The same with knots that are dense about rest, at the speeds `s sinh(k h)`, where `s` is 1e-4 of the fastest: for levels
/// that rise from 0, or fall, within a small part of the speeds.
const FINE: Effect = Effect {
    name: "learned_friction",
    title: "learned friction",
    places: &[Place::Drive, Place::Transmission, Place::Link],
    physics: "Two surfaces stick until the force between them exceeds the level of friction at rest, and slide \
        against a level that depends on the slip velocity: a curve for each direction, which is learned, with a \
        jump where the velocity changes its sign. Each is a cubic spline through 6 levels at equally spaced speeds, \
        of constant slope beyond the fastest that was visited, or through 17 levels at the speeds s sinh(k h), s a \
        ten-thousandth of the fastest: one that is 0 at rest does not stick. No level is below 0, so that friction never \
        drives. Source: Karnopp, ASME J. Dynamic Systems, Measurement and Control 107 (1985); Armstrong-Helouvry, \
        Dupont, Canudas de Wit, Automatica 30 (1994).",
    remedy: "Look at the curve; compensate it by a table over the velocity.",
    parameters: &both_ways(parameters::<FINER>(LEVEL, Quantity::VELOCITY)),
    properties: &[Property::Slot(Slot::Friction)],
    law: |p| {
        let ([backward, forward], from, to) = directions(p);
        let slow = slow(from, to);
        let over =
            |fastest: f64, levels: &[f64]| Spline::new(0.0, (fastest / slow).asinh(), levels);
        Law::Friction(Friction::over_log_speed(
            [over(to, &forward), over(-from, &backward)],
            slow,
        ))
    },
    starts: neutral::<FINER>,
};

fn slow(from: f64, to: f64) -> f64 {
    SLOW * to.max(-from)
}

/// Levels of negative and of positive velocity, each from rest on, and the ends of the range.
fn directions(values: &[f64]) -> ([Vec<f64>; 2], f64, f64) {
    let (ordinates, from, to) = split(values);
    let (backward, forward) = ordinates.split_at(ordinates.len() / 2);
    let backward = backward.iter().rev().copied().collect();
    ([backward, forward.to_vec()], from, to)
}

/// Velocities of a learned friction with these values, so many in each direction, spaced as its levels are.
pub(crate) fn slip_velocities(values: &[f64], count: usize) -> Vec<f64> {
    let (_, from, to) = split(values);
    let slow = slow(from, to);
    match values.len() {
        FINER => velocities((from, to), count, |fastest, share| {
            fastest.signum() * slow * (share * (fastest.abs() / slow).asinh()).sinh()
        }),
        _ => even_velocities((from, to), count),
    }
}

/// So many equally spaced velocities in each direction.
pub(crate) fn even_velocities(range: (f64, f64), count: usize) -> Vec<f64> {
    velocities(range, count, |fastest, share| share * fastest)
}

/// So many velocities in each direction, given by the fastest and the share of their number; those at rest have a direction.
fn velocities((from, to): (f64, f64), count: usize, spaced: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let velocity = |fastest: f64, k: usize| match k {
        0 => AT_REST * fastest,
        _ => spaced(fastest, k as f64 / (count - 1) as f64),
    };
    let backward = (0..count).rev().map(|k| velocity(from, k));
    let forward = (0..count).map(|k| velocity(to, k));
    backward.chain(forward).collect()
}

/// The neutral laws over the velocity of each place.
fn neutral<const PARAMETERS: usize>(scales: &Scales) -> Vec<Vec<f64>> {
    // Both sides of the axis have the same speed, apart from the vibration.
    let speeds = scales.visited_motor_velocity();
    [speeds, scales.visited_slip(), speeds]
        .map(start::<PARAMETERS>)
        .to_vec()
}

/// The range includes 0, since each direction has its own branch.
const fn both_ways<const PARAMETERS: usize>(
    mut parameters: [Parameter; PARAMETERS],
) -> [Parameter; PARAMETERS] {
    parameters[PARAMETERS - 2].bounds = |_| (f64::MIN, 0.0);
    parameters[PARAMETERS - 1].bounds = |_| (0.0, f64::MAX);
    parameters
}

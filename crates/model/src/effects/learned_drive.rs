//! A drive of any static map.

use super::learned::{PARAMETERS, ordinate, parameters, spline, start};
use super::{Drive, Effect, Law, Place, Property, Quantity, Slot, Spline};

struct Map(Spline);

impl Drive for Map {
    fn map(&self, value: f64) -> f64 {
        value + self.0.stable(value, 1.0)
    }
}

/// A drive that makes `u + f(u)` of its input `u`.
pub const LEARNED_DRIVE: Effect = Effect {
    name: "learned_drive",
    title: "learned drive",
    places: &[Place::Drive],
    physics: "The drive makes u + f(u) of its input u, at once. The curve f is learned: a cubic spline through its \
        values at equally spaced inputs, of constant slope outside of what was asked for, or constant \
        where more input would give less. Dead zones, limits and a \
        gain that changes are such maps; what has corners is met as nearly as the knots allow. Source: Tao and \
        Kokotovic, Adaptive Control of Systems with Actuator and Sensor Nonlinearities (1996).",
    remedy: "Look at the curve; put its inverse before the drive.",
    parameters: &parameters::<PARAMETERS>(
        ordinate(
            Quantity::INPUT,
            |scales| (-2.0 * scales.input, 2.0 * scales.input),
            |scales| 0.05 * scales.input,
        ),
        Quantity::INPUT,
    ),
    properties: &[Property::Slot(Slot::Drive)],
    law: |p| Law::Drive(Box::new(Map(spline(p)))),
    starts: |scales| vec![start::<PARAMETERS>(scales.visited_input())],
};

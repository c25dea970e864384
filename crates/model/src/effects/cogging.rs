//! Cogging: a force that is periodic in position.

use super::grid::{PHASES, orders, product};
use super::shared_parameters::{AMPLITUDE, ORDER, PHASE};
use super::{Effect, Force, Law, Memory, Motion, Place, Property, Slot};

struct Cogging {
    amplitude: f64,
    order: f64,
    phase: f64,
}

impl Force for Cogging {
    fn force(&self, _motion: &Motion, x: f64, _v: f64, _memory: &Memory) -> f64 {
        self.amplitude * (self.order * x + self.phase).sin()
    }
}

/// A force periodic in the position of the motor side, or of the link: `F = A sin(N x + phase)`.
pub const COGGING: Effect = Effect {
    name: "cogging",
    title: "cogging",
    places: &[Place::Drive, Place::Link],
    physics: "Magnets pull at the teeth of the stator, with or without a current: F = A sin(N x + \
        phase), N periods in 2 pi of position, a multiple of poles and slots. Its frequency follows \
        the speed, and it does no net work over a period. Detents, and the balls of a guide, do the same at the \
        link. Source: Zhu and Howe, IEEE Trans. Energy \
        Conversion 15 (2000); Hanselman, Brushless Permanent Magnet Motor Design (2003).",
    remedy: "Look for the motor's poles, a ball screw or a bent shaft at this period; compensate it \
        by a table over the position.",
    parameters: &[AMPLITUDE, ORDER, PHASE],
    properties: &[Property::Slot(Slot::PositionForce)],
    law: |p| {
        Law::Force(Box::new(Cogging {
            amplitude: p[0],
            order: p[1],
            phase: p[2],
        }))
    },
    starts: |scales| product(&[&[0.03 * scales.force], &orders(scales, 6), &PHASES]),
};

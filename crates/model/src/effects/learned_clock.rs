//! A sensor's clock that runs in any way.

use super::learned::{FINER, PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Law, Parameter, Place, Property, Quantity, Sensor, Slot, Spline};

struct Clock(Spline);

impl Sensor for Clock {
    fn instant(&self, time: f64) -> f64 {
        time + self.0.nearest(time)
    }
}

/// Shifts of half a period of the mode and more have the minima of other periods.
const SHIFT: Parameter = ordinate(
    Quantity::TIME,
    |scales| (-0.5 * scales.period(), 0.5 * scales.period()),
    |scales| 0.1 * scales.deformation / scales.velocity,
);

/// The stamp `t` marks the motion at `t + f(t)`.
pub const LEARNED_CLOCK: Effect = Effect {
    parameters: &parameters::<PARAMETERS>(SHIFT, Quantity::TIME),
    properties: &[Property::Slot(Slot::Clock), Property::Finer(&FINE)],
    starts: |scales| vec![start::<PARAMETERS>(scales.span)],
    ..FINE
};

/// The same with finer knots, for a clock that jumps.
const FINE: Effect = Effect {
    name: "learned_clock",
    title: "learned clock",
    places: &[Place::Sensor],
    physics: "The stamp t stands on what was at t + f(t): a clock that is set while it runs, samples that are lost or counted \
        twice, a quartz that warms up. The curve is learned: a cubic spline through its values at equally spaced times, \
        constant outside of the recording. Source: Mills, Computer Network Time Synchronization (2011), chapter 3.",
    remedy: "Give both devices one clock; look for lost samples where the curve steps.",
    parameters: &parameters::<FINER>(SHIFT, Quantity::TIME),
    properties: &[Property::Slot(Slot::Clock)],
    law: |p| Law::Sensor(Box::new(Clock(spline(p)))),
    starts: |scales| vec![start::<FINER>(scales.span)],
};

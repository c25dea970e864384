//! A sensor whose zero moves in any way.

use super::learned::{PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Law, Place, Property, Quantity, Reading, Sensor, Slot, Spline};

struct Zero(Spline);

impl Sensor for Zero {
    fn read(&self, reading: &Reading) -> f64 {
        reading.value + self.0.value(reading.time)
    }
}

/// A sensor that shows `y + f(t)`.
pub const LEARNED_SENSOR_DRIFT: Effect = Effect {
    name: "learned_sensor_drift",
    title: "learned sensor drift",
    places: &[Place::Sensor],
    physics: "The sensor's zero moves by f(t), whatever the axis does: electronics that warm up and cool down, a \
        tripod that settles. The curve is learned: a cubic spline through its values at equally spaced times, of \
        constant slope outside of the recording. Source: Doebelin, Measurement Systems (2004), chapter 3 (zero drift).",
    remedy: "Let the sensor warm up, and set its zero at rest.",
    parameters: &parameters::<PARAMETERS>(
        ordinate(
            Quantity::POSITION,
            |scales| {
                let most = 10.0 * (scales.deformation + scales.travel());
                (-most, most)
            },
            |scales| 0.1 * scales.deformation,
        ),
        Quantity::TIME,
    ),
    properties: &[Property::Slot(Slot::SensorDrift)],
    law: |p| Law::Sensor(Box::new(Zero(spline(p)))),
    starts: |scales| vec![start::<PARAMETERS>(scales.span)],
};

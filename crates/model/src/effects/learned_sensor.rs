//! A sensor of any static characteristic.

use super::learned::{PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Law, Place, Property, Quantity, Reading, Sensor, Slot, Spline};

struct Characteristic(Spline);

impl Sensor for Characteristic {
    fn read(&self, reading: &Reading) -> f64 {
        reading.value + self.0.value(reading.value)
    }
}

/// A sensor that shows `y + f(y)`.
pub const LEARNED_SENSOR: Effect = Effect {
    name: "learned_sensor",
    title: "learned sensor",
    places: &[Place::Sensor],
    physics: "The sensor shows y + f(y) where the quantity is y: a scale that is not straight, a strain gauge that is \
        far bent, a lens. The curve f is learned: a cubic spline through its values at equally spaced readings, of \
        constant slope outside of what was seen. Source: Doebelin, Measurement Systems (2004), chapter 3.",
    remedy: "Look at the curve; calibrate the sensor against a known motion.",
    parameters: &parameters::<PARAMETERS>(
        ordinate(
            Quantity::POSITION,
            |scales| (-2.0 * range(scales), 2.0 * range(scales)),
            |scales| 0.02 * range(scales),
        ),
        Quantity::POSITION,
    ),
    properties: &[Property::Slot(Slot::Sensor)],
    law: |p| Law::Sensor(Box::new(Characteristic(spline(p)))),
    starts: |scales| vec![start::<PARAMETERS>(scales.visited_reading())],
};

/// Length of the range of readings.
fn range(scales: &super::Scales) -> f64 {
    let (from, to) = scales.visited_reading();
    to - from
}

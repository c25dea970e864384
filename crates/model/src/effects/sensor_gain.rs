//! A sensor with a wrong scale.

use super::grid::{reach, sizes};
use super::{
    Effect, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Reading, Sensor,
    Slot,
};

struct Gain {
    error: f64,
}

impl Sensor for Gain {
    fn read(&self, reading: &Reading) -> f64 {
        reading.value * (1.0 + self.error)
    }
}

/// The sensor shows `(1 + g) y`.
pub const SENSOR_GAIN: Effect = Effect {
    name: "sensor_gain",
    title: "sensor gain",
    places: &[Place::Sensor],
    physics: "A scale, a lever arm or a calibration factor is wrong by a part g: the sensor shows (1 + g) \
        y, at rest as in motion. On a joint's angle a hundredth of it is soon larger than the \
        deformation. Source: Doebelin, Measurement Systems (2004), chapter 3.",
    remedy: "Calibrate the sensor's scale against a known motion.",
    parameters: &[Parameter {
        name: "error",
        role: ParameterRole::Size,
        quantity: Quantity::NUMBER,
        bounds: |_| (-0.9, 5.0),
        neutral: 0.0,
        typical: |scales| (0.1 * scales.deformation / reach(scales)).min(0.1),
    }],
    properties: &[
        Property::WrongScale,
        Property::Alike(Likeness::Pose),
        Property::Slot(Slot::Sensor),
    ],
    law: |p| Law::Sensor(Box::new(Gain { error: p[0] })),
    starts: |scales| {
        if scales.tracked {
            return Vec::new();
        }
        let unit = (scales.deformation / reach(scales)).min(1.0);
        sizes(unit, [-0.1, 0.1])
    },
};

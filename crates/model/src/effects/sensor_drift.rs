//! A sensor that drifts.

use super::grid::{product, reach};
use super::levelling::{SETTLING_RATE, levelling};
use super::{
    Effect, Law, Parameter, ParameterRole, Place, Property, Quantity, Reading, Sensor, Slot,
};

struct Drift {
    rate: f64,
    growth: f64,
    settling: f64,
}

impl Sensor for Drift {
    fn read(&self, reading: &Reading) -> f64 {
        let gone = levelling(reading.time, self.settling);
        let [along, across] = match reading.tracked {
            true => [reading.value.cos(), reading.value.sin()],
            false => [1.0, reading.value],
        };
        reading.value + self.rate * (along + self.growth * across) * gone
    }
}

/// The sensor shows `y + r (1 + g y) (1 - exp(-s t)) / s`; a tracker that follows a tip in a frame that is displaced
/// `y + r (cos y + g sin y) (1 - exp(-s t)) / s`, with `y` the angle of the tip.
pub const SENSOR_DRIFT: Effect = Effect {
    name: "sensor_drift",
    title: "sensor drift",
    places: &[Place::Sensor],
    physics: "Warming electronics, a tripod that settles or an integrated rate make the reading creep, \
        whatever the axis does, at rest too: its zero by r each second, and its scale by r g. With s > 0 the \
        drift levels off: y + r (1 + g y) (1 - exp(-s t)) / s. A tracker whose frame is displaced shows the \
        angle y of a tip as y + r (cos y + g sin y) (1 - exp(-s t)) / s. Source: Doebelin, Measurement \
        Systems (2004), chapter 3 (zero drift and sensitivity drift).",
    remedy: "Let the sensor warm up, and set its zero at rest.",
    parameters: &[
        Parameter {
            name: "rate",
            role: ParameterRole::Size,
            quantity: Quantity::VELOCITY,
            bounds: |scales| {
                let most = 10.0 * (scales.deformation + scales.travel()) / scales.duration();
                (-most, most)
            },
            neutral: 0.0,
            typical: |scales| 0.1 * scales.deformation / scales.duration(),
        },
        Parameter {
            name: "growth",
            role: ParameterRole::Shape,
            quantity: Quantity::new(0, -1, 0),
            // A frame that moves across the line to the tip: the zero stays, the scale drifts.
            bounds: |scales| (-20.0 / reach(scales), 20.0 / reach(scales)),
            neutral: 0.0,
            typical: |scales| 0.3 / reach(scales),
        },
        SETTLING_RATE,
    ],
    properties: &[Property::Slot(Slot::SensorDrift)],
    law: |p| {
        Law::Sensor(Box::new(Drift {
            rate: p[0],
            growth: p[1],
            settling: p[2],
        }))
    },
    starts: |scales| {
        let rates = [-0.1, 0.1].map(|size| size * scales.deformation / scales.duration());
        let settling = [0.0, 4.0 / scales.duration()];
        product(&[&rates, &[0.0], &settling])
    },
};

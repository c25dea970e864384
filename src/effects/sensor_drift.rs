//! A sensor that drifts.

use super::grid::product;
use super::levelling::{levelling, settling_bounds};
use super::{Effect, Law, Parameter, Place, Quantity, Reading, Sensor};

struct Drift {
    rate: f64,
    sensitivity: f64,
    settling: f64,
}

impl Sensor for Drift {
    fn read(&self, reading: &Reading) -> f64 {
        let gone = levelling(reading.time, self.settling);
        reading.value + (self.rate + self.sensitivity * reading.value) * gone
    }
}

/// The sensor shows `y + (r + q y) (1 - exp(-s t)) / s`.
pub const SENSOR_DRIFT: Effect = Effect {
    name: "sensor_drift",
    places: &[Place::Sensor],
    physics: "Warming electronics, a tripod that settles or an integrated rate make the reading creep, \
        whatever the axis does, at rest too: its zero by r and its sensitivity by q each second, as a \
        tracker's frame that is displaced does, seen as an angle. With s > 0 the drift levels off: y + (r \
        + q y) (1 - exp(-s t)) / s. Source: Doebelin, Measurement Systems (2004), chapter 3 (zero drift \
        and sensitivity drift).",
    parameters: &[
        Parameter {
            name: "rate",
            quantity: Quantity::VELOCITY,
            bounds: |scales| {
                let most = 10.0 * (scales.deformation + scales.travel()) / scales.duration();
                (-most, most)
            },
            neutral: 0.0,
            typical: |scales| 0.1 * scales.deformation / scales.duration(),
        },
        Parameter {
            name: "sensitivity_rate",
            quantity: Quantity::FREQUENCY,
            bounds: |scales| (-1.0 / scales.duration(), 1.0 / scales.duration()),
            neutral: 0.0,
            typical: |_| 0.0,
        },
        Parameter {
            name: "settling_rate",
            quantity: Quantity::FREQUENCY,
            bounds: |scales| settling_bounds(scales.duration()),
            neutral: 0.0,
            typical: |_| 0.0,
        },
    ],
    law: |p| {
        Law::Sensor(Box::new(Drift {
            rate: p[0],
            sensitivity: p[1],
            settling: p[2],
        }))
    },
    starts: |scales| {
        let rates = [-0.1, 0.1].map(|size| size * scales.deformation / scales.duration());
        let settling = [0.0, 4.0 / scales.duration()];
        product(&[&rates, &[0.0], &settling])
    },
};

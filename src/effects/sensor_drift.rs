//! A sensor that drifts.

use super::grid::sizes;
use super::{Effect, Law, Parameter, Place, Quantity, Reading, Sensor};

struct Drift {
    rate: f64,
}

impl Sensor for Drift {
    fn read(&self, reading: &Reading) -> f64 {
        reading.value + self.rate * reading.time
    }
}

/// The sensor shows `y + r t`.
pub const SENSOR_DRIFT: Effect = Effect {
    name: "sensor_drift",
    places: &[Place::Sensor],
    physics: "Warming electronics, a tripod that settles or an integrated rate make the reading creep by \
        r each second, whatever the axis does, at rest too. Source: Doebelin, Measurement Systems \
        (2004), chapter 3.",
    parameters: &[Parameter {
        name: "rate",
        quantity: Quantity::VELOCITY,
        bounds: |scales| {
            let most = 10.0 * (scales.deformation + scales.travel()) / scales.duration();
            (-most, most)
        },
        neutral: 0.0,
        typical: |scales| 0.1 * scales.deformation / scales.duration(),
    }],
    law: |p| Law::Sensor(Box::new(Drift { rate: p[0] })),
    starts: |scales| {
        let unit = scales.deformation / scales.duration();
        sizes(unit, [-0.1, 0.1])
    },
};

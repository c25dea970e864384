//! A sensor that shows the past.

use super::grid::sizes;
use super::shared_parameters::DELAY;
use super::{Effect, Law, Likeness, Parameter, Place, Property, Sensor};

struct Delay {
    delay: f64,
}

impl Sensor for Delay {
    fn instant(&self, time: f64) -> f64 {
        time - self.delay
    }
}

/// A dead time of the sensor: it shows `y(t - T)`. A negative one means that the input is late.
pub const SENSOR_DELAY: Effect = Effect {
    name: "sensor_delay",
    title: "sensor delay",
    places: &[Place::Sensor],
    physics: "Exposure, averaging and transmission take time: the stamp t stands on what was at t - T. \
        A negative delay is one of the channel that drives the model: beside it the sensor is early. \
        Where the sensor's clock has an unknown offset, the two are one. Source: Astrom and \
        Wittenmark, Computer-Controlled Systems (1997), chapter 3.",
    remedy: "Shift the sensor's stamps by the delay.",
    parameters: &[Parameter {
        bounds: |scales| {
            let (_, most) = (DELAY.bounds)(scales);
            (-most, most)
        },
        ..DELAY
    }],
    properties: &[
        Property::ShiftsStamps,
        Property::Alike(Likeness::ShiftInTime),
    ],
    law: |p| Law::Sensor(Box::new(Delay { delay: p[0] })),
    starts: |scales| {
        let late = sizes(scales.period(), [0.003, 0.01, 0.03, 0.1, 0.3]);
        let early = sizes(scales.period(), [-0.003, -0.01, -0.03, -0.1, -0.3]);
        [late, early].concat()
    },
};

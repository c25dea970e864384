//! A sensor that counts steps.

use super::grid::sizes;
use super::{Effect, Law, Parameter, ParameterRole, Place, Quantity, Reading, Sensor};

struct Quantiser {
    step: f64,
}

impl Sensor for Quantiser {
    fn read(&self, reading: &Reading) -> f64 {
        match self.step > 0.0 {
            true => self.step * (reading.value / self.step).round(),
            false => reading.value,
        }
    }
}

/// The nearest whole number of steps: `q round(y / q)`.
pub const QUANTISATION: Effect = Effect {
    name: "quantisation",
    title: "quantisation",
    places: &[Place::Sensor],
    physics: "An encoder or a converter shows the nearest of its steps: an error of q / sqrt(12), like \
        noise in fast motion, a staircase in slow motion, constant at rest. Source: Widrow and Kollar, \
        Quantization Noise (2008), chapter 4.",
    remedy: "Take a finer resolution, or dither; the steps are larger than the model believes.",
    parameters: &[Parameter {
        name: "step",
        role: ParameterRole::Size,
        quantity: Quantity::POSITION,
        bounds: |scales| (0.0, 2.0 * scales.deformation),
        neutral: 0.0,
        typical: |scales| 0.05 * scales.deformation,
    }],
    properties: &[],
    law: |p| Law::Sensor(Box::new(Quantiser { step: p[0] })),
    starts: |scales| {
        sizes(
            scales.deformation,
            [0.005, 0.01, 0.02, 0.035, 0.06, 0.1, 0.17, 0.3, 0.5, 0.8],
        )
    },
};

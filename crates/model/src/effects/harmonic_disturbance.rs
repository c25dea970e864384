//! A steady vibration from outside.

use super::grid::{PHASES, frequencies, frequency_bounds, product};
use super::shared_parameters::{AMPLITUDE, PHASE};
use super::{
    Effect, Force, Law, Memory, Motion, Parameter, ParameterRole, Place, Property, Quantity, Scales,
};
use std::f64::consts::{PI, TAU};

/// Periods of the lowest frequency in a recording. Fewer are the shape of a drift or of the moves.
const LEAST_PERIODS: f64 = 4.0;

struct Harmonic {
    amplitude: f64,
    angular_frequency: f64,
    phase: f64,
}

impl Force for Harmonic {
    fn force(&self, motion: &Motion, _x: f64, _v: f64, _memory: &Memory) -> f64 {
        -self.amplitude * (self.angular_frequency * motion.time + self.phase).sin()
    }
}

/// Bounds of the angular frequency: from [`LEAST_PERIODS`] in the recording to half the sensor's rate.
fn bounds(scales: &Scales) -> (f64, f64) {
    let (_, highest) = frequency_bounds(scales);
    let lowest = LEAST_PERIODS * TAU / scales.duration();
    (
        lowest,
        highest.min(PI / scales.sample_time).max(2.0 * lowest),
    )
}

/// A force of constant frequency on the link, whatever the machine does: `F = A sin(w t + phase)`.
pub const HARMONIC_DISTURBANCE: Effect = Effect {
    name: "harmonic_disturbance",
    title: "harmonic disturbance",
    places: &[Place::Environment],
    physics: "Something beside the machine shakes the link steadily, at rest too, whatever is commanded: a fan, a \
        pump, an unbalanced rotor. F = A sin(w t + phase). Hum that the sensor picks up looks the same on a linear \
        machine. Its phase belongs to one recording. Source: Den Hartog, Mechanical Vibrations (1985), sections 2.3 \
        to 2.5; ISO 10816-1 (1995).",
    remedy: "Look for what turns or hums at this frequency: switch it off, and record again. A shaper cannot take \
        it away, since no command makes it.",
    parameters: &[
        AMPLITUDE,
        Parameter {
            name: "frequency",
            role: ParameterRole::Frequency,
            quantity: Quantity::FREQUENCY,
            bounds,
            neutral: 1.0,
            typical: |scales| 1.5 * scales.natural_frequency,
        },
        PHASE,
    ],
    properties: &[Property::Recurs],
    law: |p| {
        Law::Force(Box::new(Harmonic {
            amplitude: p[0],
            angular_frequency: p[1],
            phase: p[2],
        }))
    },
    starts: |scales| {
        let inside = |frequency: &f64| {
            let (low, high) = bounds(scales);
            (low..=high).contains(frequency)
        };
        let all: Vec<f64> = frequencies(scales, 6).into_iter().filter(inside).collect();
        product(&[&[0.03 * scales.force], &all, &PHASES])
    },
};

//! A sensor behind a low-pass filter of second order.

use super::cubic::cubic_coefficients;
use super::grid::product;
use super::sensor_lag::SENSOR_LAG;
use super::sensor_lag::{SHORT, TERMS};
use super::shared_parameters::SENSOR_TIME_CONSTANT;
use super::{Effect, Law, Likeness, Parameter, ParameterRole, Place, Property, Quantity, Sensor};

struct LowPass {
    time_constant: f64,
    damping_ratio: f64,
}

impl LowPass {
    /// Particular solution and its rate for an input with these derivatives, the third one constant:
    /// `y - c_1 y' + c_2 y'' - c_3 y'''`, the expansion of `1 / (1 + 2 xi T s + T^2 s^2)`.
    fn particular(&self, [y, v, a, j]: [f64; 4]) -> [f64; 2] {
        let (b, t2) = (
            2.0 * self.damping_ratio * self.time_constant,
            self.time_constant.powi(2),
        );
        let (c1, c2, c3) = (b, b * b - t2, b * (b * b - 2.0 * t2));
        [y - c1 * v + c2 * a - c3 * j, v - c1 * a + c2 * j]
    }

    /// Taylor series of the response and its rate after a short step `h`, for an input with these coefficients
    /// relative to the step; the particular solution would lose digits by cancellation.
    fn short_step(&self, state: [f64; 2], h: f64, input: [f64; 4]) -> [f64; 2] {
        let x = h / self.time_constant;
        let (mut term, mut next) = (state[0], h * state[1]);
        let (mut value, mut rate) = (term + next, next);
        for n in 0..TERMS {
            let order = (n + 2) as f64;
            let driven = x * x * (input.get(n).copied().unwrap_or(0.0) - term) / (order - 1.0);
            let after = (driven - 2.0 * self.damping_ratio * x * next) / order;
            value += after;
            rate += order * after;
            (term, next) = (next, after);
        }
        [value, rate / h]
    }

    /// State at the end of an interval of length `h` between two points of the input.
    fn step(&self, state: [f64; 2], before: [f64; 2], after: [f64; 2], h: f64) -> [f64; 2] {
        let [c0, c1, c2, c3] = cubic_coefficients(before, after, h);
        // Powers of x (1 + 2 xi) bound the series.
        if h * (1.0 + 2.0 * self.damping_ratio) < SHORT * self.time_constant {
            return self.short_step(state, h, [c0, h * c1, h * h * c2, h * h * h * c3]);
        }
        let start = self.particular([c0, c1, 2.0 * c2, 6.0 * c3]);
        let end = self.particular([after[0], after[1], 2.0 * c2 + 6.0 * c3 * h, 6.0 * c3]);
        let free = self.free([state[0] - start[0], state[1] - start[1]], h);
        [end[0] + free[0], end[1] + free[1]]
    }

    /// Free motion from `start` after a time `h`.
    fn free(&self, start: [f64; 2], h: f64) -> [f64; 2] {
        let (w, xi) = (1.0 / self.time_constant, self.damping_ratio);
        let (square, angle) = (1.0 - xi * xi, w * h);
        // cos and sin / sqrt(1 - xi^2), continued through critical damping.
        let root = square.abs().sqrt();
        let (c, s) = match square {
            square if root * angle < 1e-6 => (1.0 - 0.5 * square * angle * angle, angle),
            square if square > 0.0 => ((root * angle).cos(), (root * angle).sin() / root),
            _ => ((root * angle).cosh(), (root * angle).sinh() / root),
        };
        let decay = (-xi * angle).exp();
        let [z, rate] = start;
        [
            decay * (z * (c + xi * s) + rate / w * s),
            decay * (rate * (c - xi * s) - w * z * s),
        ]
    }
}

impl Sensor for LowPass {
    fn filters(&self) -> bool {
        self.time_constant > 0.0
    }

    /// Exact for the cubic through values and rates: particular solution and free motion.
    fn filter(&self, time: &[f64], curve: &mut [[f64; 2]], start: Option<[f64; 2]>) {
        if !self.filters() {
            return;
        }
        let Some(&first) = curve.first() else { return };
        let (mut state, mut before) = (start.unwrap_or([first[0], 0.0]), first);
        curve[0] = state;
        for k in 1..time.len() {
            let now = curve[k];
            state = self.step(state, before, now, time[k] - time[k - 1]);
            curve[k] = state;
            before = now;
        }
    }
}

/// Low-pass filter `T^2 z'' + 2 xi T z' + z = y` of the sensor.
pub const SENSOR_LAG_SECOND_ORDER: Effect = Effect {
    name: "sensor_lag_second_order",
    title: "second-order sensor lag",
    places: &[Place::Sensor],
    physics: "The sensor's own mass and spring, or its anti-alias filter, follow the motion as T^2 z'' + 2 \
        xi T z' + z = y: slow motion comes 2 xi T late, motion faster than 1 / T falls off with its \
        square; a lightly damped sensor rings. Source: Doebelin, Measurement Systems (2004), chapter \
        3; Oppenheim and Schafer, Discrete-Time Signal Processing (2010), appendix B.",
    remedy: "Lower the filtering in the sensor, or put its lag into the model; if it rings, look at \
        how it is mounted.",
    parameters: &[
        SENSOR_TIME_CONSTANT,
        Parameter {
            name: "damping_ratio",
            role: ParameterRole::Shape,
            quantity: Quantity::NUMBER,
            // Sensor filters are not built to ring: a Chebyshev filter with 3 dB of ripple has 0.38.
            bounds: |_| (0.3, 3.0),
            neutral: 1.0,
            typical: |_| 0.7,
        },
    ],
    properties: &[
        Property::Contains(&SENSOR_LAG),
        Property::Alike(Likeness::ShiftInTime),
        // A clock of its own absorbs most of a lag, by a different offset for each size.
        Property::ManyMinima,
    ],
    law: |p| {
        Law::Sensor(Box::new(LowPass {
            time_constant: p[0],
            damping_ratio: p[1],
        }))
    },
    starts: |scales| {
        let times = [0.01, 0.03, 0.08, 0.2, 0.5].map(|size| size * scales.period());
        product(&[&times, &[0.3, 0.8]])
    },
};

//! A sensor that follows the motion with a first-order lag.

use super::cubic::cubic_coefficients;
use super::shared_parameters::SENSOR_TIME_CONSTANT;
use super::{Effect, Law, Likeness, Place, Property, Sensor};

/// Steps shorter than this, in time constants, use a series.
pub(super) const SHORT: f64 = 0.25;
/// Number of its terms: `0.25^12 / 12!` is far below the rounding.
pub(super) const TERMS: usize = 12;

struct Lag {
    time_constant: f64,
}

impl Sensor for Lag {
    fn filters(&self) -> bool {
        self.time_constant > 0.0
    }

    fn filter(&self, time: &[f64], curve: &mut [[f64; 2]], start: Option<[f64; 2]>) {
        if self.time_constant > 0.0 {
            first_order(self.time_constant, time, curve, start);
        }
    }
}

/// Replaces `y` by the response of `T z' + z = y` and its rate, starting from `start`; without it `y` was
/// constant before the first sample.
///
/// Exact for the cubic through values and rates: with the polynomial `p = y - T y' + T^2 y'' - T^3 y^(3)` the
/// response is `p + (z_0 - p_0) exp(-s / T)`.
pub(super) fn first_order(tau: f64, time: &[f64], curve: &mut [[f64; 2]], start: Option<[f64; 2]>) {
    let Some(&first) = curve.first() else { return };
    curve[0] = start.unwrap_or([first[0], 0.0]);
    let (mut z, mut before) = (curve[0][0], first);
    for k in 1..time.len() {
        let (h, now) = (time[k] - time[k - 1], curve[k]);
        let [_, _, c2, c3] = cubic_coefficients(before, now, h);
        z = match h < SHORT * tau {
            true => short_step(
                z,
                h / tau,
                [before[0], h * before[1], h * h * c2, h * h * h * c3],
            ),
            false => {
                let particular = |y, v, a| y - tau * (v - tau * (a - tau * 6.0 * c3));
                let start = particular(before[0], before[1], 2.0 * c2);
                let end = particular(now[0], now[1], 2.0 * c2 + 6.0 * c3 * h);
                end + (z - start) * (-h / tau).exp()
            }
        };
        curve[k] = [z, (now[0] - z) / tau];
        before = now;
    }
}

/// Taylor series of the response after a step of `x` time constants, for an input with these coefficients
/// relative to the step; the polynomial would lose digits by cancellation.
fn short_step(z: f64, x: f64, input: [f64; 4]) -> f64 {
    let (mut sum, mut term) = (z, z);
    for n in 0..TERMS {
        let driven = input.get(n).copied().unwrap_or(0.0);
        term = x * (driven - term) / (n + 1) as f64;
        sum += term;
    }
    sum
}

/// First-order lag `T z' + z = y` of the sensor.
pub const SENSOR_LAG: Effect = Effect {
    name: "sensor_lag",
    title: "sensor lag",
    places: &[Place::Sensor],
    physics: "The sensor or its filter follows the motion as T z' + z = y: it shows the motion T later \
        where that is slow, and smaller where it is fast, by 1 / sqrt(1 + (w T)^2). A clock offset makes \
        the same delay but leaves the size. Source: Bendat and Piersol, Random Data (2010), section 6.",
    remedy: "Lower the filtering in the sensor, or put its lag into the model.",
    parameters: &[SENSOR_TIME_CONSTANT],
    properties: &[Property::Alike(Likeness::ShiftInTime)],
    law: |p| {
        Law::Sensor(Box::new(Lag {
            time_constant: p[0],
        }))
    },
    starts: |scales| {
        [0.01, 0.03, 0.08, 0.2, 0.5]
            .map(|size| vec![size * scales.period()])
            .to_vec()
    },
};

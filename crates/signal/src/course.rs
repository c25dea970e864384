//! Position, velocity and acceleration of a joint from its recorded positions.

use super::smoother::{Smoother, SmoothingError};
use super::{CubicSpline, End, SignalError};
use quell_recording::Channel;

/// Share of the greatest speed below which the direction of friction is not known.
const REST: f64 = 0.01;

/// A motion at the stamps of a recorded position: the smoothed state of `q''' = white noise`.
///
/// The intensity of that noise over that of the sensor is the likeliest one, and in each stretch of the motion its own, where
/// that is evident: little at rest, much where a joint knocks. It sets the bandwidth, which nobody has to choose.
#[derive(Clone, Debug)]
pub struct Course {
    /// Stamps, s.
    pub time: Vec<f64>,
    /// Position, velocity, acceleration at each.
    pub state: Vec<[f64; 3]>,
    /// The greatest speed.
    pub fastest: f64,
    /// In steps of the clock.
    error: SmoothingError,
}

impl Course {
    /// The motion of a position.
    ///
    /// # Errors
    /// [`SignalError`] for fewer than two samples, values that are not finite, a clock that stands.
    pub fn of(position: &Channel) -> Result<Self, SignalError> {
        let (time, values) = (&position.time, &position.columns[0]);
        CubicSpline::new(time, values, End::Natural)?;
        let last = time.len() - 1;
        // In steps of the clock, so that all numbers are of one size.
        let unit = (time[last] - time[0]) / last as f64;
        let steps: Vec<f64> = time
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) / unit)
            .collect();
        let (state, error) = match values.iter().all(|value| *value == values[0]) {
            true => {
                let still = vec![[values[0], 0.0, 0.0]; values.len()];
                (still, SmoothingError::none())
            }
            false => Smoother::new(values, &steps).smoothed(),
        };
        let scaled = |[q, v, a]: [f64; 3]| [q, v / unit, a / (unit * unit)];
        let state: Vec<[f64; 3]> = state.into_iter().map(scaled).collect();
        Ok(Self {
            time: time.clone(),
            fastest: state.iter().fold(0.0, |most, own| own[1].abs().max(most)),
            state,
            error,
        })
    }

    /// A joint that stands still.
    pub fn still(position: f64) -> Self {
        Self {
            time: vec![0.0],
            state: vec![[position, 0.0, 0.0]],
            fastest: 0.0,
            error: SmoothingError::none(),
        }
    }

    /// Response of the error of its positions, where it moves, to independent draws of unit variance, one for each sample: as
    /// many samples before the draw's own as from that on. The smoother leaves out what the samples do not tell, and keeps a
    /// part of their noise.
    pub fn response_of_error(&self) -> Vec<f64> {
        let moves = |k: &usize| self.moves(self.time[*k]);
        self.error.response((0..self.time.len()).filter(moves))
    }

    /// Whether it moves at an instant, so that friction has a direction: above 1 % of the greatest speed.
    pub fn moves(&self, time: f64) -> bool {
        self.at(time)[1].abs() > REST * self.fastest
    }

    /// Position, velocity and acceleration at an instant; at rest before the first stamp and after the last.
    pub fn at(&self, time: f64) -> [f64; 3] {
        let last = self.time.len() - 1;
        if time < self.time[0] || last == 0 {
            return [self.state[0][0], 0.0, 0.0];
        }
        if time > self.time[last] {
            return [self.state[last][0], 0.0, 0.0];
        }
        let k = self.time.partition_point(|t| *t <= time).clamp(1, last) - 1;
        let h = self.time[k + 1] - self.time[k];
        let (s, [a, b]) = (
            (time - self.time[k]) / h,
            [self.state[k], self.state[k + 1]],
        );
        [
            cubic(s, h, [a[0], a[1]], [b[0], b[1]]),
            cubic(s, h, [a[1], a[2]], [b[1], b[2]]),
            a[2] + s * (b[2] - a[2]),
        ]
    }
}

/// The cubic through values and rates at two ends, at the share `s` of its length `h`.
fn cubic(s: f64, h: f64, [x, v]: [f64; 2], [y, w]: [f64; 2]) -> f64 {
    let (a, b, rise) = (h * v, h * w, y - x);
    x + s * (a + s * (3.0 * rise - 2.0 * a - b + s * (a + b - 2.0 * rise)))
}

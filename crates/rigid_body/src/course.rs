//! Position, velocity and acceleration of a joint from its recorded positions.

use nalgebra::{Matrix3, Vector3};
use quell_recording::Channel;
use quell_signal::{CubicSpline, End, SignalError};

/// A motion at the stamps of a recorded position: the smoothed state of `q''' = white noise`.
///
/// The intensity of that noise over that of the sensor is the likeliest one. It sets the bandwidth, which nobody has to
/// choose.
///
/// Source: Wahba, Improper priors, spline smoothing and the problem of guarding against model errors in regression,
/// J. Royal Statistical Society B 40 (1978): the smoothed state is the smoothing spline of fifth order; Bierman, Fixed
/// interval smoothing with discrete measurements, Int. J. Control 18 (1973).
#[derive(Clone, Debug)]
pub struct Course {
    /// Stamps, s.
    pub time: Vec<f64>,
    /// Position, velocity, acceleration at each.
    pub state: Vec<[f64; 3]>,
    /// The greatest speed.
    pub fastest: f64,
}

/// Where the logarithm of the intensity is looked for: from a motion of which a million samples show the acceleration to
/// one whose every sample is all there is.
const SEARCHED: (f64, f64) = (-60.0, 10.0);

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
        let filter = Filter::new(values, &steps);
        let state = match filter.moves {
            false => vec![[values[0], 0.0, 0.0]; values.len()],
            true => filter.smoothed(filter.likeliest().exp()),
        };
        let scaled = |[q, v, a]: [f64; 3]| [q, v / unit, a / (unit * unit)];
        let state: Vec<[f64; 3]> = state.into_iter().map(scaled).collect();
        Ok(Self {
            time: time.clone(),
            fastest: state.iter().fold(0.0, |most, own| own[1].abs().max(most)),
            state,
        })
    }

    /// A joint that stands still.
    pub fn still(position: f64) -> Self {
        Self {
            time: vec![0.0],
            state: vec![[position, 0.0, 0.0]],
            fastest: 0.0,
        }
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

/// The Kalman filter of positions, the sensor's variance being 1.
struct Filter<'a> {
    values: &'a [f64],
    steps: &'a [f64],
    first: Matrix3<f64>,
    /// Whether the position is not one value throughout.
    moves: bool,
}

struct Pass {
    state: Vector3<f64>,
    covariance: Matrix3<f64>,
    innovation: f64,
    variance: f64,
}

impl<'a> Filter<'a> {
    fn new(values: &'a [f64], steps: &'a [f64]) -> Self {
        let noise = quell_signal::noise_floor(values).standard_deviation;
        let size = values
            .iter()
            .fold(0.0f64, |most, v| most.max((v - values[0]).abs()));
        let noise = noise.max(1e-9 * size);
        let differences: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let square = |of: &[f64]| of.iter().map(|d| d * d).sum::<f64>() / of.len().max(1) as f64;
        let bends: Vec<f64> = differences
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        // What is known of the start: it is like the rest.
        let [rate, bend] = [square(&differences), square(&bends)].map(|own| own / (noise * noise));
        Self {
            values,
            steps,
            first: Matrix3::from_diagonal(&Vector3::new(1.0, 4.0 * rate + 1.0, 4.0 * bend + 1.0)),
            moves: size > 0.0,
        }
    }

    fn filter(&self, intensity: f64, mut each: impl FnMut(Pass)) {
        let mut state = Vector3::new(self.values[0], 0.0, 0.0);
        let mut covariance = self.first;
        for (k, value) in self.values.iter().enumerate() {
            let (innovation, variance) = (value - state[0], covariance[(0, 0)] + 1.0);
            each(Pass {
                state,
                covariance,
                innovation,
                variance,
            });
            let Some(&h) = self.steps.get(k) else { return };
            let gain = covariance.column(0) / variance;
            let leads = transition(h);
            state = leads * (state + gain * innovation);
            let updated = covariance - gain * covariance.row(0);
            let next = leads * updated * leads.transpose() + noise(h) * intensity;
            covariance = (next + next.transpose()) * 0.5;
        }
    }

    /// Log-likelihood, the sensor's variance concentrated out.
    fn likelihood(&self, intensity: f64) -> f64 {
        let (mut squares, mut logs) = (0.0, 0.0);
        self.filter(intensity, |pass| {
            squares += pass.innovation * pass.innovation / pass.variance;
            logs += pass.variance.ln();
        });
        let count = self.values.len() as f64;
        -0.5 * count * (squares / count).max(f64::MIN_POSITIVE).ln() - 0.5 * logs
    }

    /// The logarithm of the likeliest intensity: by thirds about the best of a grid.
    fn likeliest(&self) -> f64 {
        let (from, to) = SEARCHED;
        let steps = 28;
        let at = |k: i32| from + (to - from) * f64::from(k) / f64::from(steps);
        let all = (0..=steps).map(|k| (self.likelihood(at(k).exp()), at(k)));
        let best = all
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map_or(from, |own| own.1);
        let width = (to - from) / f64::from(steps);
        let (mut low, mut high) = (best - width, best + width);
        while high - low > 0.2 {
            let third = (high - low) / 3.0;
            let [left, right] = [low + third, high - third].map(|log| self.likelihood(log.exp()));
            match left < right {
                true => low += third,
                false => high -= third,
            }
        }
        0.5 * (low + high)
    }

    fn smoothed(&self, intensity: f64) -> Vec<[f64; 3]> {
        let mut passes = Vec::with_capacity(self.values.len());
        self.filter(intensity, |pass| passes.push(pass));
        let mut smoothed = vec![[0.0; 3]; passes.len()];
        let mut adjoint = Vector3::zeros();
        for (k, pass) in passes.iter().enumerate().rev() {
            let mut before = Vector3::zeros();
            if let Some(&h) = self.steps.get(k) {
                let back = transition(h).transpose() * adjoint;
                let gain = pass.covariance.column(0) / pass.variance;
                before = back;
                before[0] -= gain.dot(&back);
            }
            before[0] += pass.innovation / pass.variance;
            adjoint = before;
            let own = pass.state + pass.covariance * adjoint;
            smoothed[k] = own.into();
        }
        smoothed
    }
}

fn transition(h: f64) -> Matrix3<f64> {
    Matrix3::new(1.0, h, 0.5 * h * h, 0.0, 1.0, h, 0.0, 0.0, 1.0)
}

/// The covariance that white jerk adds.
fn noise(h: f64) -> Matrix3<f64> {
    let (h2, h3) = (h * h, h * h * h);
    Matrix3::new(
        h3 * h2 / 20.0,
        h2 * h2 / 8.0,
        h3 / 6.0,
        h2 * h2 / 8.0,
        h3 / 3.0,
        h2 / 2.0,
        h3 / 6.0,
        h2 / 2.0,
        h,
    )
}

//! Noise of the recorded input and of known forces, as a part of the noise of the outputs.
//!
//! A simulation carries the noise of a measured motion through the chain: a mode of damping ratio 0.03 makes it
//! seventeen times as loud at its own frequency. Let `h` be the response of an output's rows to the noise of one
//! sample, and `rho` the autocovariance of the sensor's own noise. That of both is
//!
//! ```text
//! r_l = rho_l + (N_in / N_out) sum_i h_i h_(i+l)
//! ```
//!
//! It is that of an autoregressive moving average. Its poles `A` are those of the sensor's noise and, behind a
//! mode, the two of `h`; the moving average is the spectral factor of `A r A*`.
//!
//! An encoder's rounding is such noise while it moves by more than a step per sample. The noise of a velocity whose
//! integral drives the model adds up: `h` is then the response to a step, and an output that keeps the step has this
//! covariance in its differences, so that these are whitened. A smoothed position, whose second derivative is taken, errs by what
//! its smoother leaves out and by what it keeps of the noise: `h` is then the response to a draw of that error. Its density is
//! that of a motion whose jerk is white, and more than that of a planned move.
//!
//! Source: Soederstroem, Errors-in-Variables Methods in System Identification (2018), chapter 2, for a noisy
//! input; Brockwell and Davis, Time Series: Theory and Methods (1991), section 5.2, for the innovations
//! algorithm.

use super::input_error::noise;
use super::point::Point;
use super::problem::Problem;
use super::whitening::{Innovation, Whitening, differences};
use quell_model::{Experiment, InputError};
use quell_signal::polynomial;
use std::cell::LazyCell;

/// Places of a recording, as shares of its length, at which the response is taken: an error between the nodes
/// of a smoothed input moves the chain less than one at a node.
const PLACES: [f64; 3] = [0.17, 0.31, 0.52];
/// Lags over which the poles of a response are fitted. A response has lost its smoothing by then and is still
/// ringing.
const LAGS: usize = 400;
/// Poles of noise without a moving average: enough for a mode beside white noise of a hundredth of its variance.
const POLES: usize = 40;
/// Most steps of the innovations algorithm: a moving average of a mode forgets within a period.
const STEPS: usize = 1000;
/// Spectral density of the heard noise at its peak, relative to that of the sensor's innovations, below which it is ignored:
/// standard deviations are then too small by half of that at most.
const UNHEARD: f64 = 0.02;
/// Relative change of a standard deviation below which a moving average is steady.
const STEADY: f64 = 1e-9;

impl Problem<'_> {
    /// Standard deviation of the noise of an experiment's input, where that is a part of the noise of its outputs.
    pub fn heard_input_noise(&self, e: usize) -> Option<f64> {
        let experiment = &self.experiments[e];
        let error = InputError::of(experiment);
        // What rounds a force is part of what drives the axis: its errors add up, and windows forget them.
        let is_rounded_force = self.scales.forced && error.of_noise().is_none();
        let heard = experiment.windows.is_empty() && !is_rounded_force;
        heard
            .then(|| noise(error, &experiment.input_values))
            .flatten()
    }

    /// The noise of every output of an experiment with that of what drives it, at a point; `own` is the sensors'.
    pub fn with_input_noise(&self, point: &Point, e: usize, own: &[Whitening]) -> Vec<Whitening> {
        let heard = self.heard(point, e);
        let outputs = own.iter().zip(&self.experiments[e].outputs).enumerate();
        let both = outputs.map(|(k, (own, output))| {
            let samples = output.values.len() as f64;
            let adds_up = |heard: &&Heard| heard.adds_up && output.role.is_position();
            let walks = heard.iter().any(|own| adds_up(&own));
            let mut covariance = vec![0.0; LAGS + 1];
            for own in &heard {
                own.add_to(&mut covariance, (k, walks), samples);
            }
            if walks {
                // The variance of a walk about its mean.
                let walked = heard.iter().filter(adds_up);
                let walked = walked.map(|own| own.deviation.powi(2) * own.samples / 6.0);
                let deviation = (own.deviation.powi(2) + walked.sum::<f64>()).sqrt();
                let both = walking(own, &covariance);
                return both.map_or_else(|| own.clone(), |both| Whitening { deviation, ..both });
            }
            let peak = 2.0 * covariance.iter().map(|c| c.abs()).sum::<f64>();
            let both = (peak > UNHEARD * own.innovation.powi(2)).then(|| beside(own, &covariance));
            both.flatten().unwrap_or_else(|| own.clone())
        });
        both.collect()
    }

    /// What the outputs of an experiment hear of the noise of its input and of its known forces, at a point.
    fn heard(&self, point: &Point, e: usize) -> Vec<Heard> {
        let here = LazyCell::new(|| self.run(point, e).residuals);
        let respond =
            |driven: &dyn Fn(f64) -> Experiment| self.response_to((point, &here), e, driven);
        let experiment = &self.experiments[e];
        let mut all = heard_of_forces(experiment, respond);
        if let Some(deviation) = self.heard_input_noise(e) {
            let inputs = &experiment.input_values;
            let adds_up = matches!(InputError::of(experiment), InputError::Walk(_));
            let response = |place: f64| {
                let shape = shape_of_error(experiment, (deviation, adds_up), place);
                respond(&|sign| {
                    let mut other = inputs.clone();
                    shape.iter().for_each(|(k, own)| other[*k] += sign * own);
                    experiment.with_input(other)
                })
            };
            all.push(Heard {
                samples: draws_of_input(experiment) as f64,
                deviation,
                adds_up,
                responses: PLACES.map(response),
            });
        }
        all
    }
}

/// Number of draws of the error of an input. The response of a smoothed one is taken where the outputs have rows, and they have
/// none at rest.
fn draws_of_input(experiment: &Experiment) -> usize {
    let (inputs, stamps) = (&experiment.input_time, &experiment.outputs[0].time);
    if experiment.input_smoothed.is_none() {
        return inputs.len();
    }
    let half = 0.5 * experiment.mean_interval();
    let is_read = |time: &&f64| {
        let next = stamps.partition_point(|stamp| *stamp < **time - half);
        stamps.get(next).is_some_and(|stamp| *stamp < **time + half)
    };
    inputs.iter().filter(is_read).count()
}

/// Change of the samples of an input by a draw of its error at a place: a share of its length, or of the outputs' rows where it
/// was smoothed.
fn shape_of_error(
    experiment: &Experiment,
    (deviation, adds_up): (f64, bool),
    place: f64,
) -> Vec<(usize, f64)> {
    let count = experiment.input_values.len();
    let at = |count: usize| (place * count as f64) as usize;
    if let Some(response) = &experiment.input_smoothed {
        let stamps = &experiment.outputs[0].time;
        let stamp = stamps.get(at(stamps.len())).copied().unwrap_or_default();
        let middle = experiment.input_time.partition_point(|time| *time < stamp);
        let sample = |k: usize| (middle + k).checked_sub(response.len() / 2);
        let shape = response.iter().enumerate();
        let shape = shape.filter_map(|(k, own)| Some((sample(k)?, *own)));
        return shape.filter(|own| own.0 < count).collect();
    }
    let until = if adds_up { count } else { at(count) + 1 };
    (at(count)..until).map(|k| (k, deviation)).collect()
}

/// What the outputs hear of a noise.
struct Heard {
    /// Number of its samples.
    samples: f64,
    /// Standard deviation of a sample.
    deviation: f64,
    /// Whether a sample acts until the end.
    adds_up: bool,
    /// Responses of the rows of each output to a sample of this size, at each of the places.
    responses: [Vec<Vec<f64>>; PLACES.len()],
}

impl Heard {
    /// Adds the autocovariance of what an output of so many samples hears, or of its differences.
    fn add_to(&self, covariance: &mut [f64], (output, walks): (usize, bool), samples: f64) {
        let share = self.samples / samples / PLACES.len() as f64;
        for rows in &self.responses {
            let rows = match walks {
                true => differences(&rows[output]),
                false => rows[output].clone(),
            };
            for (lag, sum) in covariance.iter_mut().enumerate() {
                *sum += share * product(&rows, lag);
            }
        }
    }
}

/// What the outputs hear of the noise of known forces; `respond` has the change of the residuals of another experiment.
fn heard_of_forces(
    experiment: &Experiment,
    respond: impl Fn(&dyn Fn(f64) -> Experiment) -> Vec<Vec<f64>>,
) -> Vec<Heard> {
    let known = &experiment.known;
    let heard = |(force, (samples, deviation)): (usize, (usize, f64))| {
        // The errors of a force on an axis that nothing brings back add up, and windows forget them.
        let is_heard = deviation > 0.0 && experiment.windows.is_empty();
        let response = |place: f64| {
            let sample = (place * samples as f64) as usize;
            respond(&|sign| Experiment {
                known: known.with_force_changed(force, sample, sign * deviation),
                ..experiment.clone()
            })
        };
        is_heard.then(|| Heard {
            samples: samples as f64,
            deviation,
            adds_up: false,
            responses: PLACES.map(response),
        })
    };
    let forces = known.noise_of_forces().into_iter().enumerate();
    forces.filter_map(heard).collect()
}

/// `sum_i x_i x_(i+lag)`.
fn product(x: &[f64], lag: usize) -> f64 {
    x.iter().zip(x.iter().skip(lag)).map(|(a, b)| a * b).sum()
}

/// A sensor's noise with noise of an autocovariance beside it; `None` where it cannot be whitened.
fn beside(own: &Whitening, heard: &[f64]) -> Option<Whitening> {
    together(own, &own.response(), heard, 2)
}

/// A sensor's noise beside noise whose differences have this autocovariance. A walk has no standard deviation: that of the
/// differences is told.
fn walking(own: &Whitening, heard: &[f64]) -> Option<Whitening> {
    let mut response = own.response();
    response.insert(0, 0.0);
    let both = together(own, &differences(&response), heard, 3)?;
    Some(Whitening {
        walks: true,
        ..both
    })
}

/// The sum of two noises, of which one is a sensor's with this response to an innovation and the other has this
/// autocovariance. It rings with a mode or does not ring: as the moving average, which is longer than the sensor's poles by
/// `more`, leaves out less. `None` where neither has one.
fn together(own: &Whitening, response: &[f64], heard: &[f64], more: usize) -> Option<Whitening> {
    let power = own.innovation.powi(2);
    let both = |(lag, heard): (usize, &f64)| power * product(response, lag) + heard;
    let covariance: Vec<f64> = heard.iter().enumerate().map(both).collect();
    let mut poles = vec![1.0];
    poles.extend(own.coefficients.iter().map(|a| -a));
    let order = own.coefficients.len() + more;
    let still = Filtered::new(&covariance, poles.clone(), order);
    let ringing = poles_of(heard)
        .map(|mode| Filtered::new(&covariance, polynomial::product(&poles, &mode), order));
    let least = ringing.filter(|own| own.left_out() < still.left_out());
    let whitening = least.unwrap_or(still).whitening();
    whitening.or_else(|| autoregressive(&covariance))
}

/// Noise of poles alone that has this autocovariance up to their number, by the recursion of Levinson and Durbin: where no
/// moving average has it, as where the response still rings after the last lag. `None` of no noise.
///
/// Source: Brockwell and Davis (1991), section 5.2.
fn autoregressive(covariance: &[f64]) -> Option<Whitening> {
    let (mut a, mut error) = (Vec::<f64>::new(), covariance[0]);
    for order in 1..=POLES {
        let known = a.iter().enumerate();
        let known: f64 = known.map(|(k, a)| a * covariance[order - 1 - k]).sum();
        let reflection = (covariance[order] - known) / error;
        let left = error * (1.0 - reflection * reflection);
        if left.is_nan() || left <= 0.0 {
            break;
        }
        let before = a.clone();
        for (a, mirrored) in a.iter_mut().zip(before.iter().rev()) {
            *a -= reflection * mirrored;
        }
        a.push(reflection);
        error = left;
    }
    (error > 0.0).then(|| Whitening {
        coefficients: a,
        moving_average: Vec::new(),
        innovation: error.sqrt(),
        deviation: covariance[0].sqrt(),
        walks: false,
    })
}

/// Noise whose autoregressive part is filtered out.
struct Filtered<'a> {
    covariance: &'a [f64],
    poles: Vec<f64>,
    /// Autocovariance of what is left, and the order of its moving average.
    left: Vec<f64>,
    order: usize,
}

impl<'a> Filtered<'a> {
    fn new(covariance: &'a [f64], poles: Vec<f64>, order: usize) -> Self {
        let count = poles.len();
        let at = |lag: usize| -> f64 {
            let pairs = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
            let of =
                |(i, j): (usize, usize)| poles[i] * poles[j] * covariance[(lag + i).abs_diff(j)];
            pairs.map(of).sum()
        };
        let left = (0..covariance.len() - count).map(at).collect();
        Self {
            covariance,
            poles,
            left,
            order,
        }
    }

    /// Share of the autocovariance beyond the order of the moving average.
    fn left_out(&self) -> f64 {
        let beyond: f64 = self.left[self.order + 1..].iter().map(|c| c * c).sum();
        beyond.sqrt() / self.left[0]
    }

    fn whitening(&self) -> Option<Whitening> {
        let first = self.poles.len() - 1;
        // Of the first samples, which the poles do not filter, with one behind them.
        let crossed = |lag: usize| -> f64 {
            let all = self.poles.iter().enumerate();
            all.map(|(k, pole)| pole * self.covariance[lag.abs_diff(k)])
                .sum()
        };
        let moving_average = innovations(self.order, |later, earlier| match later - earlier {
            lag if lag > self.order => 0.0,
            lag if later < first => self.covariance[lag],
            lag if earlier < first => crossed(lag),
            lag => self.left[lag],
        })?;
        Some(Whitening {
            coefficients: self.poles[1..].iter().map(|a| -a).collect(),
            innovation: moving_average.last()?.deviation,
            moving_average,
            deviation: self.covariance[0].sqrt(),
            walks: false,
        })
    }
}

/// `1 - a_1 z - a_2 z^2` that fits `c_l = a_1 c_(l-1) + a_2 c_(l-2)` best; `None` where it is not stable.
fn poles_of(c: &[f64]) -> Option<[f64; 3]> {
    let (mut xx, mut xy, mut yy, mut xc, mut yc) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for lag in 3..c.len() {
        let (own, x, y) = (c[lag], c[lag - 1], c[lag - 2]);
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        (xc, yc) = (xc + x * own, yc + y * own);
    }
    let determinant = xx * yy - xy * xy;
    let (first, second) = (
        (xc * yy - yc * xy) / determinant,
        (yc * xx - xc * xy) / determinant,
    );
    let is_stable = second.abs() < 1.0 && first.abs() < 1.0 - second;
    is_stable.then_some([1.0, -first, -second])
}

/// Moving average of order `q` with a covariance, from the first sample on until it is steady; `None` where
/// there is none.
fn innovations(q: usize, covariance: impl Fn(usize, usize) -> f64) -> Option<Vec<Innovation>> {
    let mut all: Vec<Innovation> = Vec::new();
    let variance = |own: &Innovation| own.deviation.powi(2);
    for n in 0..STEPS {
        let mut gains = vec![0.0; q.min(n)];
        for lag in (1..=gains.len()).rev() {
            let earlier = &all[n - lag];
            let common = earlier.gains.iter().zip(&gains[lag..]).enumerate();
            let shared = common.map(|(j, (a, b))| a * b * variance(&all[n - lag - 1 - j]));
            gains[lag - 1] = (covariance(n, n - lag) - shared.sum::<f64>()) / variance(earlier);
        }
        let known = gains.iter().zip(all.iter().rev());
        let known: f64 = known.map(|(b, own)| b * b * variance(own)).sum();
        let left = covariance(n, n) - known;
        if left.is_nan() || left <= 0.0 {
            return None;
        }
        let deviation = left.sqrt();
        all.push(Innovation { gains, deviation });
        // Over all lags: where one lag counts alone, innovations are alike in runs of its length.
        let is_steady = |before: &Innovation| (deviation / before.deviation - 1.0).abs() < STEADY;
        if n > 2 * q && all[n - q.max(1)..].iter().all(is_steady) {
            break;
        }
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The factor of a moving average with roots outside the unit circle is itself.
        #[test]
        fn val_a_moving_average_is_found_again(a in -0.9..0.9f64, b in -0.9..0.9f64, variance in 0.1..10.0f64) {
            let own = polynomial::product(&[1.0, a], &[1.0, b]);
            let covariance: Vec<f64> = (0..3).map(|lag| variance * product(&own, lag)).collect();
            let at = |later: usize, earlier: usize| covariance.get(later - earlier).copied();
            let all = innovations(2, |later, earlier| at(later, earlier).unwrap_or(0.0)).unwrap();
            let found = all.last().unwrap();
            for (found, own) in found.gains.iter().zip(&own[1..]) {
                prop_assert!((found - own).abs() < 1e-4);
            }
            prop_assert!((found.deviation.powi(2) / variance - 1.0).abs() < 1e-4);
        }

        /// Also where the first lag has almost no share.
        #[test]
        fn val_a_moving_average_of_the_second_lag_is_found_again(a in 0.5..0.9f64, rest in -1e-4..1e-4f64) {
            let own = polynomial::product(&[1.0, a + rest], &[1.0, -a]);
            let covariance: Vec<f64> = (0..3).map(|lag| product(&own, lag)).collect();
            let at = |later: usize, earlier: usize| covariance.get(later - earlier).copied();
            let all = innovations(2, |later, earlier| at(later, earlier).unwrap_or(0.0)).unwrap();
            prop_assert!((all.last().unwrap().gains[1] - own[2]).abs() < 1e-4);
        }
    }

    /// White noise beside white noise that has passed a mode becomes white.
    #[test]
    fn noise_behind_a_mode_is_whitened() {
        let (radius, angle): (f64, f64) = (0.99, 0.1);
        let mode = Whitening {
            coefficients: vec![2.0 * radius * angle.cos(), -radius * radius],
            moving_average: Vec::new(),
            innovation: 0.02,
            deviation: 1.0,
            walks: false,
        };
        let response = mode.response();
        let heard: Vec<f64> = (0..=LAGS)
            .map(|lag| 4e-4 * product(&response, lag))
            .collect();
        let both = beside(&Whitening::white(0.5), &heard).unwrap();
        let mut random: rand_chacha::ChaCha8Rng = rand::SeedableRng::seed_from_u64(5);
        let noise = [&Whitening::white(0.5), &mode].map(|own| own.draw(40_000, &mut random));
        let noise: Vec<f64> = noise[0].iter().zip(&noise[1]).map(|(a, b)| a + b).collect();
        let mut rows = Vec::new();
        // In stretches, whose first rows have no known past.
        for stretch in noise.chunks(200) {
            both.apply(stretch, &mut rows);
        }
        let at = |lag| product(&rows, lag) / rows.len() as f64;
        // Standard deviations of 0.007 and 0.005.
        assert!((at(0) - 1.0).abs() < 0.035, "{}", at(0));
        for lag in [1, 2, 3, 10, 31, 63] {
            assert!(at(lag).abs() < 0.025, "{lag}: {}", at(lag));
        }
    }
}

//! The super-twisting observer: a second-order sliding mode that tracks the deformation.
//!
//! With `x1 = delta`, `e1 = x1 - xhat1` (eqs. 13 and 14, `f = 0`):
//! ```text
//! xhat1' = xhat2 + z1,  z1 = lambda |e1|^(1/2) sign e1
//! xhat2' = z2,          z2 = alpha sign e1
//! alpha > f+,  lambda > sqrt(2 / (alpha - f+)) (alpha + f+) (1 + p) / (1 - p),  0 < p < 1
//! ```
//! (erratum: one gain lambda, printed also as beta; the factor stands outside the root; the gain in
//! eq. 19 is alpha). In the sliding mode `v = xhat2 + z1` is the velocity.

use super::least_squares::LeastSquares;
use super::regression::{Hearing, Settling};
use super::{Estimate, Estimator, Sample, Settings};

/// `alpha / f+`.
const ALPHA: f64 = 2.0;
/// `p` of the theorem, near its lower end: the noise of `v` grows with lambda.
const MARGIN: f64 = 0.01;
/// Steps of the observer in one period of the highest expected frequency.
const STEPS_A_PERIOD: f64 = 1000.0;
/// Steps at most in one sample.
const MOST_STEPS: f64 = 500.0;
/// Time constant of the filter, over the expected period: 6 ms at 8 Hz, two samples of a tracker at 333 Hz. A
/// faster filter would pass the chatter at the sample rate, a slower one would add delay.
const FILTER: f64 = 1.0 / 20.0;
/// Time constants after which less than 5 % of the initial state is left.
const FORGOTTEN: f64 = 3.0;

/// The super-twisting estimator, for a free decay.
///
/// The velocity `v`, and the deformation, pass the same filter of two equal poles; filters commute
/// with the equation of motion, so `v_f' = -a1 x_f - a2 v_f` stays exact (filtering `z_eq` and
/// `xhat2` by one pole each is biased). `f+ = w^2` times the amplitude (the largest deformation,
/// or velocity over `w`, so far), `w` from the belief and a quarter more.
///
/// # Cost
/// Up to 500 sub-steps of the observer a sample, since its sign terms chatter at the step's
/// length; nothing is allocated.
#[derive(Clone, Debug)]
pub struct SuperTwisting {
    settings: Settings,
    /// Expected frequency, a quarter above the belief.
    bound: f64,
    state: State,
    settling: Settling,
}

/// State that a restart discards.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    last: Option<Sample>,
    begin: f64,
    largest: f64,
    position: f64,
    velocity: f64,
    filtered_velocity: TwoPole,
    filtered_position: TwoPole,
    filtered_offset: TwoPole,
    equations: LeastSquares,
    hearing: Hearing,
}

/// Two equal poles, `tau s + 1` squared; both states are outputs.
#[derive(Clone, Copy, Debug, Default)]
struct TwoPole {
    first: f64,
    second: f64,
}

impl TwoPole {
    /// One step of length `step`, the input constant on it (exact).
    fn push(&mut self, input: f64, ratio: f64, decay: f64) {
        let first = self.first - input;
        let second = self.second - input;
        self.second = input + decay * (second + ratio * first);
        self.first = input + decay * first;
    }

    fn slope(&self, time_constant: f64) -> f64 {
        (self.first - self.second) / time_constant
    }
}

impl SuperTwisting {
    /// An observer whose gains follow the belief and the amplitude seen.
    pub fn new(settings: &Settings) -> Self {
        let w = settings.belief.map_or_else(
            || (settings.frequency_range.0 * settings.frequency_range.1).sqrt(),
            |mode| mode.natural_frequency(),
        );
        Self {
            settings: *settings,
            bound: 1.25 * w,
            state: State::default(),
            settling: Settling::new(settings),
        }
    }

    fn time_constant(&self) -> f64 {
        FILTER * core::f64::consts::TAU * 1.25 / self.bound
    }

    /// Adds the equation `v_f' = -a1 x_f - a2 v_f` at the last sample, weighted by a step (s).
    fn equate(&mut self, step: f64) {
        let tau = self.time_constant();
        let state = &mut self.state;
        let row = [
            -state.filtered_position.second,
            -state.filtered_velocity.second,
            0.0,
            state.filtered_offset.second,
            0.0,
        ];
        let slope = state.filtered_velocity.slope(tau);
        state.equations.push(row, slope, step);
    }

    /// The observer over one sample's interval, its input a line between the samples.
    fn track(&mut self, last: Sample, sample: Sample) {
        let interval = sample.time - last.time;
        let period = core::f64::consts::TAU / self.bound;
        let steps = (interval * STEPS_A_PERIOD / period)
            .ceil()
            .clamp(1.0, MOST_STEPS);
        let step = interval / steps;
        let tau = self.time_constant();
        let ratio = step / tau;
        let decay = (-ratio).exp();
        let force = self.bound * self.bound * self.state.largest;
        let alpha = ALPHA * force;
        let lambda = (2.0 / (alpha - force).max(f64::MIN_POSITIVE)).sqrt()
            * (alpha + force)
            * ((1.0 + MARGIN) / (1.0 - MARGIN));
        let state = &mut self.state;
        for k in 0..steps as usize {
            let part = (k as f64 + 0.5) / steps;
            let measured = last.deformation + part * (sample.deformation - last.deformation);
            let error = measured - state.position;
            let sign = if error > 0.0 { 1.0 } else { -1.0 };
            let velocity = state.velocity + lambda * error.abs().sqrt() * sign;
            state.position += step * velocity;
            state.velocity += step * alpha * sign;
            state.filtered_velocity.push(velocity, ratio, decay);
            state.filtered_position.push(measured, ratio, decay);
            state.filtered_offset.push(1.0, ratio, decay);
        }
    }
}

impl State {
    /// Takes the first sample, at which the observer starts.
    fn begin_with(&mut self, sample: Sample) {
        self.hearing.push(sample.deformation);
        self.begin = sample.time;
        self.position = sample.deformation;
        self.largest = sample.deformation.abs();
        self.filtered_position = TwoPole {
            first: sample.deformation,
            second: sample.deformation,
        };
        self.last = Some(sample);
    }
}

impl Estimator for SuperTwisting {
    fn observe(&mut self, sample: Sample) {
        if !sample.is_finite() || self.settling.is_frozen() {
            return;
        }
        let Some(last) = self.state.last else {
            self.state.begin_with(sample);
            return;
        };
        if sample.time <= last.time {
            return;
        }
        self.state.hearing.push(sample.deformation);
        self.state.largest = self.state.largest.max(sample.deformation.abs());
        self.track(last, sample);
        let rate = self.state.filtered_velocity.second.abs() / self.bound;
        self.state.largest = self.state.largest.max(rate);
        self.state.last = Some(sample);
        // The velocity's error, at most w times the amplitude, falls by at least alpha - f+ = f+
        // a second, so the sliding mode is reached within 1 / w, and half of that for the spiral's
        // end.
        let begin = self.state.begin + 1.5 / self.bound + FORGOTTEN * self.time_constant();
        if sample.time < begin || !self.state.hearing.hears(self.settings.noise_std) {
            return;
        }
        self.equate(sample.time - last.time);
        let used = [true, true, false, self.settings.offset_is_free(), false];
        if let Some([stiffness, damping, ..]) = self.state.equations.solve(used) {
            self.settling.push(sample.time, stiffness, damping, 0.0);
        }
    }

    fn estimate(&self) -> Option<Estimate> {
        self.settling.estimate()
    }

    fn restart(&mut self) {
        self.state = State::default();
        self.settling.restart();
    }
}

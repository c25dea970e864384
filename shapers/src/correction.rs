//! Smooth steps that add up to nothing and cancel a vibration.

use crate::Setpoint;
use crate::modal_state::ModalState;
use crate::smooth_step::step_at;
use arrayvec::ArrayVec;
use num_complex::Complex64;
use num_traits::Float;

/// Modes that one correction can cancel.
pub const CORRECTED_MODES: usize = 3;
/// Steps that one correction can have.
pub(crate) const CORRECTION_STEPS: usize = 25;
/// Steps that can be under way or planned at the same time.
pub(crate) const SCHEDULED_STEPS: usize = 96;
/// Zero sum, and real and imaginary part of value and slope for each mode.
const CONDITIONS: usize = 1 + 4 * CORRECTED_MODES;
/// A number for each step.
type Steps = [f64; CORRECTION_STEPS];
/// A condition: the share of each step, and the sum that all must add up to.
type Conditions = ArrayVec<(Steps, f64), CONDITIONS>;
/// A least norm needs free unknowns: with as many steps as conditions there is only one solution.
const SPARE: usize = 2;

/// The vibration of each mode that a correction cancels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// The vibration.
    Value,
    /// The vibration and its slope over the mode.
    Slope,
}

impl Order {
    fn rows_per_mode(self) -> usize {
        match self {
            Order::Value => 2,
            Order::Slope => 4,
        }
    }

    /// Fewest steps for so many modes.
    pub fn fewest_steps(self, modes: usize) -> usize {
        1 + self.rows_per_mode() * modes + SPARE
    }
}

/// A smooth step of `amplitude` over `ticks` ticks after tick `start`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub start: u64,
    pub ticks: usize,
    pub amplitude: f64,
}

impl Step {
    pub fn end(&self) -> u64 {
        self.start + self.ticks as u64
    }

    pub fn at(&self, tick: u64, sample_time: f64) -> Setpoint {
        if tick <= self.start {
            return Setpoint::default();
        }
        if tick >= self.end() {
            return Setpoint::at_rest(self.amplitude);
        }
        let elapsed = tick.saturating_sub(self.start) as f64;
        scaled(step_at(elapsed, self.ticks, sample_time), self.amplitude)
    }
}

pub(crate) fn scaled(setpoint: Setpoint, factor: f64) -> Setpoint {
    Setpoint {
        position: setpoint.position * factor,
        velocity: setpoint.velocity * factor,
        acceleration: setpoint.acceleration * factor,
    }
}

pub(crate) fn sum(a: Setpoint, b: Setpoint) -> Setpoint {
    Setpoint {
        position: a.position + b.position,
        velocity: a.velocity + b.velocity,
        acceleration: a.acceleration + b.acceleration,
    }
}

/// The steps that a filter adds to its output.
#[derive(Clone, Debug, Default)]
pub(crate) struct Schedule {
    steps: ArrayVec<Step, SCHEDULED_STEPS>,
    /// Sum of the amplitudes of the steps that are over.
    offset: f64,
}

impl Schedule {
    pub fn clear(&mut self) {
        self.steps.clear();
        self.offset = 0.0;
    }

    #[inline]
    pub fn is_idle(&self) -> bool {
        self.steps.is_empty()
    }

    /// Whether nothing is added from now on. After dropped steps the finished ones need not add up to zero.
    pub fn adds_nothing(&self) -> bool {
        self.steps.is_empty() && self.offset == 0.0
    }

    /// The correction at `tick`.
    pub fn output(&self, tick: u64, sample_time: f64) -> Setpoint {
        let start = Setpoint::at_rest(self.offset);
        self.steps
            .iter()
            .fold(start, |total, step| sum(total, step.at(tick, sample_time)))
    }

    /// Retires the steps that are over at `tick`. After the last one nothing is left to the bit: the
    /// amplitudes add up to zero but for rounding.
    pub fn tidy(&mut self, tick: u64) {
        let offset = &mut self.offset;
        self.steps.retain(|step| {
            let over = step.end() <= tick;
            *offset += if over { step.amplitude } else { 0.0 };
            !over
        });
        if self.steps.is_empty() {
            self.offset = 0.0;
        }
    }

    /// Drops the steps that have not begun at `tick`; the sum of those that have is to be undone.
    pub fn drop_future(&mut self, tick: u64) -> f64 {
        self.steps.retain(|step| step.start < tick);
        self.offset + self.steps.iter().map(|step| step.amplitude).sum::<f64>()
    }

    /// Tick at which the last step ends.
    pub fn end(&self) -> u64 {
        self.steps.iter().map(Step::end).max().unwrap_or(0)
    }

    pub fn remaining_capacity(&self) -> usize {
        self.steps.remaining_capacity()
    }

    /// Adds steps as far as they fit: ask [`Self::remaining_capacity`] before.
    pub fn extend(&mut self, steps: impl Iterator<Item = Step>) {
        let room = self.steps.remaining_capacity();
        self.steps.extend(steps.take(room));
    }
}

/// `count` equal smooth steps, `spacing` ticks apart, the first after tick `start`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Comb {
    pub start: u64,
    pub count: usize,
    pub spacing: usize,
    pub ticks: usize,
}

impl Comb {
    pub fn span(&self) -> usize {
        (self.count - 1) * self.spacing + self.ticks
    }

    /// Start of the `i`-th step.
    fn start_of(&self, i: usize) -> u64 {
        self.start + (i * self.spacing) as u64
    }

    /// Amplitudes of least norm with `sum c_i = total` that leave nothing of the modes, whose states
    /// without them, referred to tick `now`, are given with their poles.
    ///
    /// `None` where the conditions depend on each other.
    pub fn amplitudes(
        &self,
        now: u64,
        modes: &[(Complex64, ModalState)],
        order: Order,
        total: f64,
    ) -> Option<[f64; CORRECTION_STEPS]> {
        let per_mode = order.rows_per_mode();
        let mut conditions = Conditions::new();
        conditions.push(([1.0; CORRECTION_STEPS], total));
        for (pole, state) in modes {
            // Referred to the end of the comb, and the slope in units of the step's width, so that rows are
            // of like size: at the start what damps well would outweigh all else by exp(2 xi omega t).
            let first = conditions.len();
            let end = (self.start - now) as f64 + self.span() as f64;
            let wanted = self.parts(state.later(*pole, end));
            for part in &wanted[..per_mode] {
                conditions.push(([0.0; CORRECTION_STEPS], -part));
            }
            let spacing = self.spacing as f64;
            let turn = pole.scale(spacing).exp();
            let mut state = self.single(*pole).later(*pole, self.ticks as f64);
            for i in (0..self.count).rev() {
                let rows = conditions[first..].iter_mut().zip(self.parts(state));
                rows.for_each(|((row, _), part)| row[i] = part);
                state = state.turned(turn, spacing);
            }
        }
        least_norm(self.count, &conditions)
    }

    fn parts(&self, state: ModalState) -> [f64; 4] {
        let slope = state.slope.scale(1.0 / self.ticks as f64);
        [state.value.re, state.value.im, slope.re, slope.im]
    }

    /// State left by one step of amplitude 1, as sampled, referred to its start.
    fn single(&self, pole: Complex64) -> ModalState {
        let samples = (1..=self.ticks).map(|k| step_at(k as f64, self.ticks, 1.0).position);
        ModalState::of_future(pole, 0.0, samples)
    }

    /// The steps with their amplitudes.
    pub fn steps<'a>(&'a self, amplitudes: &'a [f64]) -> impl Iterator<Item = Step> + 'a {
        amplitudes
            .iter()
            .take(self.count)
            .enumerate()
            .map(|(i, &amplitude)| Step {
                start: self.start_of(i),
                ticks: self.ticks,
                amplitude,
            })
    }

    /// The sum of the steps at `tick`.
    pub fn output(&self, tick: u64, sample_time: f64, amplitudes: &[f64]) -> Setpoint {
        let elapsed = tick.saturating_sub(self.start) as usize;
        // Steps before `first` are over, steps from `end` on have not begun.
        let over = (elapsed + 1).saturating_sub(self.ticks);
        let first = over.div_ceil(self.spacing).min(self.count);
        let end = (elapsed.div_ceil(self.spacing)).min(self.count);
        let settled: f64 = amplitudes[..first].iter().sum();
        (first..end).fold(Setpoint::at_rest(settled), |total, i| {
            let since = (elapsed - i * self.spacing) as f64;
            sum(
                total,
                scaled(step_at(since, self.ticks, sample_time), amplitudes[i]),
            )
        })
    }
}

/// The `x` of least norm with `M x = right`, `M` given by its rows, of which the first `count` numbers count: each condition in turn adds its part that
/// is orthogonal to those before (modified Gram-Schmidt, twice, as the conditions of a mode that damps well
/// are nearly those of its slope). `M' (M M')^-1 right` is the same, and squares how ill they are.
///
/// Source: A. Bjorck, "Numerical Methods for Least Squares Problems", SIAM 1996, section 2.4.
fn least_norm(count: usize, conditions: &Conditions) -> Option<Steps> {
    let dot = |a: &Steps, b: &Steps| -> f64 {
        let both = a[..count].iter().zip(&b[..count]);
        both.map(|(a, b)| a * b).sum()
    };
    let add = |to: &mut Steps, by: f64, what: &Steps| {
        let both = to[..count].iter_mut().zip(&what[..count]);
        both.for_each(|(to, what)| *to += by * what);
    };
    let mut basis = ArrayVec::<Steps, CONDITIONS>::new();
    let mut solution = [0.0; CORRECTION_STEPS];
    for (row, right) in conditions {
        let mut own = *row;
        for before in basis.iter().chain(&basis) {
            let shared = dot(&own, before);
            add(&mut own, -shared, before);
        }
        let length = Float::sqrt(dot(&own, &own));
        if length <= f64::EPSILON * Float::sqrt(dot(row, row)) {
            return None;
        }
        own.iter_mut().for_each(|part| *part /= length);
        let missing = right - dot(row, &solution);
        add(&mut solution, missing / length, &own);
        basis.push(own);
    }
    let is_finite = solution.iter().all(|value: &f64| value.is_finite());
    is_finite.then_some(solution)
}

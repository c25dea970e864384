//! Smooth steps that add up to nothing and cancel a vibration.

use crate::complex::Complex;
use crate::linear::solve;
use crate::smooth_step::step_at;
use crate::{Mode, Setpoint};
use arrayvec::ArrayVec;

/// Modes that one correction can cancel.
pub const CORRECTED_MODES: usize = 3;
/// Steps that one correction can have.
pub(crate) const CORRECTION_STEPS: usize = 25;
/// Steps that can be under way or planned at the same time.
pub(crate) const SCHEDULED_STEPS: usize = 96;
/// Zero sum, and a real and an imaginary part for each mode.
const CONDITIONS: usize = 1 + 2 * CORRECTED_MODES;

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

    pub fn is_idle(&self) -> bool {
        self.steps.is_empty()
    }

    /// What is added at `tick`.
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

    /// Amplitudes of least norm with `sum c_i = total` that leave nothing of the modes, where
    /// `vibration` is `sum du_k exp(-lambda (t_k - t_now))` of each without them.
    ///
    /// `None` where the conditions depend on each other.
    pub fn amplitudes(
        &self,
        now: u64,
        sample_time: f64,
        modes: &[(Mode, Complex)],
        total: f64,
    ) -> Option<[f64; CORRECTION_STEPS]> {
        let size = 1 + 2 * modes.len();
        let mut rows = [[0.0; CORRECTION_STEPS]; CONDITIONS];
        let mut right = [0.0; CONDITIONS];
        rows[0][..self.count].fill(1.0);
        right[0] = total;
        for (k, (mode, vibration)) in modes.iter().enumerate() {
            // Referred to the start of the comb, so that the columns are of like size.
            let pole = Complex::new(-mode.decay_rate(), mode.damped_frequency()).scale(sample_time);
            let delay = (self.start - now) as f64;
            let single = self.step_vibration(pole);
            let wanted = *vibration * pole.scale(delay).exp();
            (right[1 + 2 * k], right[2 + 2 * k]) = (-wanted.re, -wanted.im);
            for i in 0..self.count {
                let column = single * pole.scale(-((i * self.spacing) as f64)).exp();
                (rows[1 + 2 * k][i], rows[2 + 2 * k][i]) = (column.re, column.im);
            }
        }
        let mut gram = [[0.0; CONDITIONS]; CONDITIONS];
        for i in 0..size {
            for k in 0..size {
                gram[i][k] = rows[i].iter().zip(&rows[k]).map(|(a, b)| a * b).sum();
            }
        }
        let multipliers = solve(size, &mut gram, &mut right)?;
        let mut amplitudes = [0.0; CORRECTION_STEPS];
        for (row, multiplier) in rows.iter().zip(&multipliers).take(size) {
            for (amplitude, entry) in amplitudes.iter_mut().zip(row) {
                *amplitude += multiplier * entry;
            }
        }
        amplitudes
            .iter()
            .all(|amplitude| amplitude.is_finite())
            .then_some(amplitudes)
    }

    /// `sum ds_k exp(-lambda t_k)` of one step of amplitude 1 that starts at 0, as sampled.
    fn step_vibration(&self, pole: Complex) -> Complex {
        let mut before = 0.0;
        let mut total = Complex::default();
        for k in 1..=self.ticks {
            let position = step_at(k as f64, self.ticks, 1.0).position;
            total = total + pole.scale(-(k as f64)).exp().scale(position - before);
            before = position;
        }
        total
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

    /// What the steps add at `tick`.
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

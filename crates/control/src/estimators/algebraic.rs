//! The algebraic method: iterated time-weighted integrals that annihilate the initial state.
//!
//! For a signal `x`, with `t` from the window's start (eq. 10):
//! ```text
//! eta1[x] = t^2 x - 4 int s x + 2 iint x      stands for x''
//! eta2[x] = int s^2 x - 2 iint s x            stands for x'
//! eta3[x] = iint s^2 x                        stands for x
//! ```
//! Each stands for `t^2` times a derivative, integrated twice by parts, so no derivative of a
//! measured signal and no initial condition is left.

use super::least_squares::{COLUMNS, LeastSquares};
use super::quadrature::Integral;
use super::regression::{Hearing, Settling};
use super::{Estimate, Estimator, Sample, Settings};

/// The regression that is formed from the integrals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AlgebraicForm {
    /// The paper's three unknowns, `eta1[delta] + a2 eta2[delta] + a1 eta3[delta] = a3 eta3[u]`:
    /// valid in a free decay only.
    ///
    /// Source: eqs. (9) to (11) as corrected (erratum: as printed alpha_1 and alpha_2 are
    /// interchanged and the unknowns multiply the wrong columns).
    Paper,
    /// `eta1[y] = -a1 eta3[delta] - a2 eta2[delta] - c eta2[u]`, `y = u + delta`: right in motion
    /// and at rest; `c = a2` with the damper to ground, 0 with the damper across the joint. At rest
    /// the column of `c` vanishes and is dropped. Where the settings leave the scale `s` free,
    /// `eta1[delta] = -a1 eta3[delta] - a2 eta2[delta] - s eta1[u] - c eta2[u]`.
    Energetic,
    /// The same with both sides integrated once more, which averages more noise.
    Integrated,
}

/// The algebraic estimator.
///
/// # Cost
/// Some twenty integrals and one 5 x 5 solution a sample; nothing is allocated.
#[derive(Clone, Debug)]
pub struct Algebraic {
    settings: Settings,
    form: AlgebraicForm,
    state: State,
    settling: Settling,
}

/// State that a restart discards.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    first: Option<Sample>,
    last: Option<Sample>,
    position: Kernel,
    deformation: Kernel,
    input: Kernel,
    constant: Kernel,
    extra: [Integral; COLUMNS + 1],
    equations: LeastSquares,
    moved: f64,
    largest: f64,
    position_seen: f64,
    hearing: Hearing,
}

impl State {
    /// Restarts the integrals and keeps the equations. The integrals annihilate the initial state, so that it
    /// may be another one.
    fn begin_stretch(&mut self) {
        *self = Self {
            last: self.last,
            equations: self.equations,
            moved: self.moved,
            largest: self.largest,
            position_seen: self.position_seen,
            hearing: self.hearing,
            ..Self::default()
        };
    }
}

/// The integrals of one signal.
#[derive(Clone, Copy, Debug, Default)]
struct Kernel {
    moments: [Integral; 3],
    iterated: [Integral; 3],
    eta: [f64; 3],
}

impl Kernel {
    fn push(&mut self, t: f64, x: f64, step: f64) {
        let powers = [x, t * x, t * t * x];
        for ((moment, iterated), power) in
            self.moments.iter_mut().zip(&mut self.iterated).zip(powers)
        {
            iterated.push(moment.push(power, step), step);
        }
        let [_, once, twice] = self.moments.map(|integral| integral.value());
        let [plain, linear, square] = self.iterated.map(|integral| integral.value());
        self.eta = [
            powers[2] - 4.0 * once + 2.0 * plain,
            twice - 2.0 * linear,
            square,
        ];
    }
}

impl Algebraic {
    /// An estimator of this form.
    pub fn new(settings: &Settings, form: AlgebraicForm) -> Self {
        Self {
            settings: *settings,
            form,
            state: State::default(),
            settling: Settling::new(settings),
        }
    }

    /// The row `p theta = q` at this sample, `theta = a1, a2, c or a3, a1 times the offset, scale`.
    fn row(&self) -> ([f64; COLUMNS], f64) {
        let State {
            position,
            deformation,
            input,
            constant,
            ..
        } = &self.state;
        let row = [
            -deformation.eta[2],
            -deformation.eta[1],
            -input.eta[1],
            constant.eta[2],
            -input.eta[0],
        ];
        match self.form {
            AlgebraicForm::Paper => ([row[0], row[1], input.eta[2], 0.0, 0.0], deformation.eta[0]),
            _ if self.settings.scale_is_free() => (row, deformation.eta[0]),
            _ => (row, position.eta[0]),
        }
    }

    /// Columns that carry information: the input's once it has moved by more than the noise, the offset's where
    /// the settings allow one.
    fn used(&self) -> [bool; COLUMNS] {
        if self.form == AlgebraicForm::Paper {
            // A position of zero is no column; two unknowns are then left.
            return [true, true, self.state.position_seen > 0.0, false, false];
        }
        let noise = self.settings.noise_std.unwrap_or(0.01 * self.state.largest);
        let moves = self.state.moved > 10.0 * noise;
        let scale = moves && self.settings.scale_is_free();
        [true, true, moves, self.settings.offset_is_free(), scale]
    }

    /// Length of the integrals before a restart, s. It is the settings' memory, but at most one and a half
    /// periods of the present estimate, or of the slowest mode in range without one. With noise, or a slightly
    /// nonlinear mode, the integrals drift within three periods.
    fn stretch(&self) -> f64 {
        let w = self
            .settling
            .estimate()
            .map_or(self.settings.frequency_range.0, |estimate| {
                estimate.mode.natural_frequency()
            });
        self.settings.memory.min(1.5 * core::f64::consts::TAU / w)
    }

    /// Adds a sample to the integrals of all signals; returns the time since the last sample of this stretch,
    /// s.
    fn integrate(&mut self, sample: Sample) -> f64 {
        let state = &mut self.state;
        let last = state.last.filter(|_| state.first.is_some());
        let step = last.map_or(0.0, |last| sample.time - last.time);
        state.last = Some(sample);
        let first = *state.first.get_or_insert(sample);
        let t = sample.time - first.time;
        let moved = sample.motor_position - first.motor_position;
        // The paper's third column is the position itself; the form with y needs only the motion.
        let input = if self.form == AlgebraicForm::Paper {
            sample.motor_position
        } else {
            moved
        };
        state.moved = state.moved.max(moved.abs());
        state.position_seen = state.position_seen.max(sample.motor_position.abs());
        state.largest = state.largest.max(sample.deformation.abs());
        state.position.push(t, moved + sample.deformation, step);
        state.deformation.push(t, sample.deformation, step);
        state.input.push(t, input, step);
        state.constant.push(t, 1.0, step);
        step
    }

    /// Adds the equation at the last sample, weighted by a step (s).
    fn equate(&mut self, step: f64) {
        let (mut row, mut value) = self.row();
        if self.form == AlgebraicForm::Integrated {
            for (k, entry) in row.iter_mut().enumerate() {
                *entry = self.state.extra[k].push(*entry, step);
            }
            value = self.state.extra[COLUMNS].push(value, step);
        }
        self.state.equations.push(row, value, step);
    }

    fn solve(&mut self, time: f64) {
        let Some([stiffness, damping, third, ..]) = self.state.equations.solve(self.used()) else {
            return;
        };
        let gain = if self.form == AlgebraicForm::Paper {
            third / stiffness
        } else {
            0.0
        };
        self.settling.push(time, stiffness, damping, gain);
    }
}

impl Estimator for Algebraic {
    fn observe(&mut self, sample: Sample) {
        let advances = self.state.last.is_none_or(|last| sample.time > last.time);
        if !(sample.is_finite() && advances) || self.settling.is_frozen() {
            return;
        }
        let begun = self.state.first;
        if begun.is_some_and(|first| sample.time - first.time >= self.stretch()) {
            if !self.state.hearing.hears(self.settings.noise_std) {
                // Noise alone must not affect the estimate of a later vibration.
                self.state.equations = LeastSquares::default();
            }
            self.state.begin_stretch();
        }
        self.state.hearing.push(sample.deformation);
        let step = self.integrate(sample);
        self.equate(step);
        if self.state.hearing.hears(self.settings.noise_std) {
            self.solve(sample.time);
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

//! Servo, transmission and link of one joint as a linear chain, integrated exactly.

use arrayvec::ArrayVec;
use quell_shapers::Mode;

use super::robot::{Damping, Servo};

/// Most modes of one joint.
pub const MAX_MODES: usize = 4;

/// One mode driven by the motor's acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Oscillator {
    pub mode: Mode,
    pub damping: Damping,
    pub participation: f64,
}

/// Motor side, modal deformations and command, each with its derivatives.
#[derive(Clone, Debug, Default, PartialEq)]
struct State {
    motor: [f64; 2],
    modes: ArrayVec<[f64; 2], MAX_MODES>,
    /// `r, r', r'', r'''`; the last is constant within a period.
    command: [f64; 4],
}

/// The chain command -> servo -> motor position `u` -> modal deformations `delta_i`.
///
/// `u'' + 2 z w u' + w^2 u = w^2 r + f 2 z w r'` and, for each mode with participation `p`,
/// `delta'' + 2 xi w delta' + w^2 delta = -p (u'' + c 2 xi w u')`, `c` = 1 for a damper to ground and
/// 0 for one across the joint. The command is a cubic in each period, so that the whole is an
/// autonomous linear system `z' = A z` and `z(t + h) = exp(A h) z`, summed as a Taylor series whose
/// remainder is below rounding: no discretisation error at any step.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    servo: Servo,
    oscillators: ArrayVec<Oscillator, MAX_MODES>,
    state: State,
}

impl Axis {
    /// An axis at rest at `position` (rad).
    pub fn at_rest(
        servo: Servo,
        oscillators: ArrayVec<Oscillator, MAX_MODES>,
        position: f64,
    ) -> Self {
        let state = State {
            motor: [position, 0.0],
            modes: oscillators.iter().map(|_| [0.0; 2]).collect(),
            command: [position, 0.0, 0.0, 0.0],
        };
        Self {
            servo,
            oscillators,
            state,
        }
    }

    pub fn oscillators(&self) -> &[Oscillator] {
        &self.oscillators
    }

    /// Replaces the modes; deformation and its velocity stay as they are.
    pub fn set_modes(&mut self, modes: impl IntoIterator<Item = Mode>) {
        for (oscillator, mode) in self.oscillators.iter_mut().zip(modes) {
            oscillator.mode = mode;
        }
    }

    pub fn motor(&self) -> [f64; 2] {
        self.state.motor
    }

    /// `delta` and `delta'`, summed over the modes.
    pub fn deformation(&self) -> [f64; 2] {
        self.state
            .modes
            .iter()
            .fold([0.0; 2], |sum, m| [sum[0] + m[0], sum[1] + m[1]])
    }

    /// Sets the state of the first mode, as for a free decay.
    pub fn set_deformation(&mut self, deformation: f64, velocity: f64) {
        if let Some(first) = self.state.modes.first_mut() {
            *first = [deformation, velocity];
        }
    }

    pub fn command(&self) -> [f64; 2] {
        [self.state.command[0], self.state.command[1]]
    }

    /// Sets the command from here to `position` in `period`: with a velocity a cubic that keeps the velocity
    /// continuous, without one a straight line.
    pub fn begin_period(&mut self, position: f64, velocity: Option<f64>, period: f64) {
        let [start, start_velocity, ..] = self.state.command;
        let mean = (position - start) / period;
        self.state.command = match velocity {
            None => [start, mean, 0.0, 0.0],
            Some(end_velocity) => {
                let second = (6.0 * mean - 4.0 * start_velocity - 2.0 * end_velocity) / period;
                let third = (6.0 * (start_velocity + end_velocity) - 12.0 * mean) / period.powi(2);
                [start, start_velocity, second, third]
            }
        };
    }

    /// At the end of a period the command equals its target to the last bit.
    pub fn end_period(&mut self, position: f64, velocity: Option<f64>) {
        let velocity = velocity.unwrap_or(self.state.command[1]);
        self.state.command = [position, velocity, 0.0, 0.0];
    }

    /// Advances by `h` (s) within a period.
    pub fn advance(&mut self, h: f64) {
        if h <= 0.0 {
            return;
        }
        let fastest = self
            .oscillators
            .iter()
            .map(|o| o.mode.natural_frequency())
            .fold(self.servo.bandwidth, f64::max);
        let steps = (fastest * h).ceil().max(1.0);
        for _ in 0..steps as u64 {
            self.taylor_step(h / steps);
        }
    }

    /// `exp(A h) z` for `|A h|` of the order of 1: the k-th term is below 4^k / k!, 1e-18 at 36.
    fn taylor_step(&mut self, h: f64) {
        let mut term = self.state.clone();
        for k in 1..=36 {
            term = self.derivative(&term).scaled(h / f64::from(k));
            self.state.add(&term);
        }
    }

    /// `A z`.
    fn derivative(&self, z: &State) -> State {
        let Servo {
            bandwidth: w,
            damping_ratio,
            velocity_feed_forward,
        } = self.servo;
        let rate = 2.0 * damping_ratio * w;
        let [u, u_dot] = z.motor;
        let [r, r_dot, r_ddot, r_dddot] = z.command;
        let u_ddot = w * w * (r - u) + rate * (velocity_feed_forward * r_dot - u_dot);
        let modes =
            self.oscillators
                .iter()
                .zip(&z.modes)
                .map(|(oscillator, &[delta, delta_dot])| {
                    let omega = oscillator.mode.natural_frequency();
                    let decay = 2.0 * oscillator.mode.decay_rate();
                    let ground = match oscillator.damping {
                        Damping::AcrossJoint => 0.0,
                        Damping::ToGround => decay,
                    };
                    let drive = oscillator.participation * (u_ddot + ground * u_dot);
                    [
                        delta_dot,
                        -decay * delta_dot - omega * omega * delta - drive,
                    ]
                });
        State {
            motor: [u_dot, u_ddot],
            modes: modes.collect(),
            command: [r_dot, r_ddot, r_dddot, 0.0],
        }
    }
}

impl State {
    fn scaled(mut self, factor: f64) -> Self {
        self.motor.iter_mut().for_each(|x| *x *= factor);
        self.modes.iter_mut().flatten().for_each(|x| *x *= factor);
        self.command.iter_mut().for_each(|x| *x *= factor);
        self
    }

    fn add(&mut self, other: &Self) {
        self.motor
            .iter_mut()
            .zip(other.motor)
            .for_each(|(x, y)| *x += y);
        self.modes
            .iter_mut()
            .flatten()
            .zip(other.modes.iter().flatten())
            .for_each(|(x, y)| *x += y);
        self.command
            .iter_mut()
            .zip(other.command)
            .for_each(|(x, y)| *x += y);
    }
}

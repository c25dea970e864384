//! The vibration of a command from now on, without the deformation that its acceleration forces.
//!
//! A command of velocity `v` and acceleration `a` forces `phi = sum du_k exp(lambda tau_k)` to
//!
//! ```text
//! phi_forced = du r - a T^2 z r^2,    z = exp(lambda T),    r = 1 / (1 - z)
//! ```
//!
//! (`du` is the last increment, `T` the tick; geometric sums). The rest, `psi = phi - phi_forced`, rings: in cruise
//! and at rest `|psi|` is the envelope of the vibration. The acceleration of a correction does not count as forced:
//! a correction deforms the joint as much as the vibration that it cancels.

use crate::Setpoint;
use crate::correction::CORRECTION_STEPS;
use crate::modal_state::ModalState;
use core::ops::Range;
use num_complex::Complex64;
use num_traits::Float;

/// Strides in a period. Within a stride the increments count as equal, which errs by `(2 pi / 32)^2 / 24`, 0.2 %.
const STRIDES: f64 = 32.0;
/// Quarter periods that are kept one by one: the longest cross-fade and correction, and some more.
pub(crate) const BINS: usize = 48;
/// Quarter periods of the longest correction.
const LONGEST: usize = CORRECTION_STEPS + 3;
/// Longest time, in periods, for which a vibration counts: without damping it would never end.
const RINGS: f64 = 20.0;

/// The setpoint of a tick, and how much of its acceleration is planned.
pub(crate) type Sent = (Setpoint, f64);

/// A mode whose vibration is predicted; times in ticks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Meter {
    pub pole: Complex64,
    /// Variance of the pole.
    variance: f64,
    /// Ticks of a stride and of a quarter period.
    stride: usize,
    pub quarter: usize,
    sample_time: f64,
    /// `exp(lambda stride)`.
    turn: Complex64,
    /// The vibration that equal increments which add up to 1 leave at the end of a stride.
    ramp: ModalState,
    /// The deformation that an increment of 1 a tick forces, and an acceleration of 1 a tick^2.
    velocity: ModalState,
    acceleration: ModalState,
}

/// The vibration of a command from now on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Profile {
    /// The last tick, counted from now.
    pub at: usize,
    /// The state there.
    pub state: ModalState,
    position: f64,
    /// Largest amplitude where no acceleration is planned, of all and of each quarter period.
    largest: f64,
    amplitude: [f64; BINS],
    /// `int |psi|^2 dt` until the end of each quarter period, and of all.
    until: [f64; BINS],
    pub energy: f64,
}

impl Profile {
    /// Of nothing yet: everything sent up to `now` has left `state`.
    pub fn from(state: ModalState, now: Setpoint) -> Self {
        Self {
            at: 0,
            state,
            position: now.position,
            largest: 0.0,
            amplitude: [0.0; BINS],
            until: [0.0; BINS],
            energy: 0.0,
        }
    }

    /// Energy after the first `bins` quarter periods.
    pub fn energy_after(&self, bins: usize) -> f64 {
        match bins.checked_sub(1) {
            Some(last) => self.energy - self.until.get(last).copied().unwrap_or(self.energy),
            None => self.energy,
        }
    }
}

/// Whether beside the planned acceleration the amplitudes of the modes together stay below those of another command in the given quarter periods,
/// looked at half a period before and after, and `slack`.
pub(crate) fn stays_below(
    own: &[Profile],
    other: &[Profile],
    bins: Range<usize>,
    slack: f64,
) -> bool {
    let together = |profiles: &[Profile], bin: usize| -> f64 {
        profiles.iter().map(|profile| profile.amplitude[bin]).sum()
    };
    let end = bins.end.min(BINS);
    (bins.start.min(end)..end).all(|bin| {
        let near = bin.saturating_sub(2)..(bin + 3).min(BINS);
        let largest = near.map(|near| together(other, near)).fold(0.0, f64::max);
        together(own, bin) <= largest + slack
    })
}

/// Energy of all modes.
pub(crate) fn energy(profiles: &[Profile]) -> f64 {
    profiles.iter().map(|profile| profile.energy).sum()
}

/// Largest amplitude of a mode where no acceleration is planned.
pub(crate) fn largest(profiles: &[Profile]) -> f64 {
    profiles
        .iter()
        .fold(0.0, |largest, profile| profile.largest.max(largest))
}

/// Ticks of a quarter period.
pub(crate) fn quarter(pole: Complex64) -> usize {
    (Float::round(0.5 * core::f64::consts::PI / pole.im) as usize).max(1)
}

impl Meter {
    /// For a pole (1/ticks) of a variance (1/ticks^2), at ticks of `sample_time` (s), with quarter periods of so many
    /// ticks: those of the first of several modes.
    pub fn new(pole: Complex64, variance: f64, sample_time: f64, quarter: usize) -> Self {
        let period = core::f64::consts::TAU / pole.im;
        let stride = (period / STRIDES).max(1.0) as usize;
        let z = pole.exp();
        let r = (Complex64::ONE - z).inv();
        let (zr, zrr) = (z * r, z * r * r);
        let even = (1..=stride).map(|k| k as f64 / stride as f64);
        Self {
            pole,
            variance,
            stride,
            quarter,
            sample_time,
            turn: pole.scale(stride as f64).exp(),
            ramp: ModalState::of_future(pole, 0.0, even).later(pole, stride as f64),
            velocity: ModalState {
                value: r,
                slope: zrr,
            },
            acceleration: ModalState {
                value: -zrr,
                slope: -(zrr + (zr * zr * r).scale(2.0)),
            },
        }
    }

    /// The same mode known exactly.
    pub fn exact(&self) -> Self {
        Self {
            variance: 0.0,
            ..*self
        }
    }

    /// The profile of a command that comes to rest after `rest` ticks, and of its decay, which is followed as
    /// long as any correction lasts.
    pub fn profile(
        &self,
        state: ModalState,
        now: Setpoint,
        rest: usize,
        sent: impl FnMut(usize) -> Sent,
    ) -> Profile {
        let mut profile = Profile::from(state, now);
        let until = rest.max(LONGEST * self.quarter);
        self.follow(&mut profile, until, f64::INFINITY, sent);
        profile.energy += self.decay(profile.state);
        profile
    }

    /// Goes on to `until` ticks from now, rounded up to whole strides, or to where the energy exceeds `most`.
    /// `sent` tells of a tick, counted from now.
    pub fn follow(
        &self,
        profile: &mut Profile,
        until: usize,
        most: f64,
        mut sent: impl FnMut(usize) -> Sent,
    ) {
        while profile.at < until && profile.energy <= most {
            let bin = profile.at / self.quarter;
            profile.at += self.stride;
            let (now, planned) = sent(profile.at);
            let increment = now.position - profile.position;
            profile.position = now.position;
            let left = profile.state.turned(self.turn, self.stride as f64);
            profile.state = left.sum(self.ramp.scaled(increment));
            let square = self.ringing(profile.state, now, planned);
            profile.energy += square * self.stride as f64;
            let free = if planned == 0.0 {
                Float::sqrt(square)
            } else {
                0.0
            };
            profile.largest = profile.largest.max(free);
            if bin < BINS {
                profile.amplitude[bin] = profile.amplitude[bin].max(free);
                profile.until[bin] = profile.energy;
            }
        }
    }

    /// `E |psi|^2`: the square of what rings, and what the variance of the pole adds to it.
    fn ringing(&self, state: ModalState, sent: Setpoint, planned: f64) -> f64 {
        let (tick, square) = (self.sample_time, self.sample_time * self.sample_time);
        let increment = sent.velocity * tick - 0.5 * sent.acceleration * square;
        let forced = self.velocity.scaled(increment);
        let forced = forced.sum(self.acceleration.scaled(planned * square));
        self.expected(state.less(forced))
    }

    /// `E |phi|^2 = |phi|^2 + var(lambda) |d phi / d lambda|^2`.
    fn expected(&self, state: ModalState) -> f64 {
        state.value.norm_sqr() + self.variance * state.slope.norm_sqr()
    }

    /// Energy of the decay of a state after the command has come to rest.
    pub fn decay(&self, state: ModalState) -> f64 {
        let shortest = self.pole.im / (core::f64::consts::TAU * RINGS);
        self.expected(state) / (-2.0 * self.pole.re).max(shortest)
    }
}

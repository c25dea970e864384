//! The plain structures of the header, and what they stand for.

use crate::status::Status;
use quell_shapers::{
    GridTrain, Mode, MotionLimits, Residual, RetuneOutcome, Setpoint, ShaperError, TRAIN_CAPACITY,
    Tap,
};

/// `quell_mode`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct PlainMode {
    natural_frequency: f64,
    damping_ratio: f64,
}

impl PlainMode {
    pub(crate) fn checked(self) -> Result<Mode, Status> {
        Mode::new(self.natural_frequency, self.damping_ratio).map_err(|_| Status::Mode)
    }
}

/// `quell_setpoint` and `quell_limits`: three numbers by position, velocity and acceleration or by
/// velocity, acceleration and jerk.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct PlainSetpoint(f64, f64, f64);

impl From<PlainSetpoint> for Setpoint {
    fn from(PlainSetpoint(position, velocity, acceleration): PlainSetpoint) -> Self {
        Self {
            position,
            velocity,
            acceleration,
        }
    }
}

impl From<PlainSetpoint> for MotionLimits {
    fn from(PlainSetpoint(velocity, acceleration, jerk): PlainSetpoint) -> Self {
        Self {
            velocity,
            acceleration,
            jerk,
        }
    }
}

impl From<Setpoint> for PlainSetpoint {
    fn from(setpoint: Setpoint) -> Self {
        Self(setpoint.position, setpoint.velocity, setpoint.acceleration)
    }
}

/// `quell_tap`.
#[derive(Clone, Copy, Default)]
#[repr(C)]
struct PlainTap {
    delay: u32,
    amplitude: f64,
}

/// `quell_train`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct PlainTrain {
    sample_time: f64,
    count: u32,
    taps: [PlainTap; TRAIN_CAPACITY],
}

impl PlainTrain {
    pub(crate) fn checked(&self) -> Result<GridTrain, Status> {
        let taps = self.taps.get(..self.count as usize).ok_or(Status::Train)?;
        let mut found = [Tap {
            delay: 0,
            amplitude: 0.0,
        }; TRAIN_CAPACITY];
        for (tap, plain) in found.iter_mut().zip(taps) {
            (tap.delay, tap.amplitude) = (plain.delay, plain.amplitude);
        }
        GridTrain::from_taps(&found[..taps.len()], self.sample_time).map_err(|error| match error {
            ShaperError::OutOfRange { .. } => Status::Train,
            other => other.into(),
        })
    }
}

impl From<&GridTrain> for PlainTrain {
    fn from(train: &GridTrain) -> Self {
        let mut plain = Self {
            sample_time: train.sample_time(),
            count: train.taps().len() as u32,
            taps: [PlainTap::default(); TRAIN_CAPACITY],
        };
        for (plain, tap) in plain.taps.iter_mut().zip(train.taps()) {
            (plain.delay, plain.amplitude) = (tap.delay, tap.amplitude);
        }
        plain
    }
}

/// `quell_correction`.
#[derive(Clone, Copy, Default)]
#[repr(C)]
pub struct Correction {
    installed: i32,
    robust: i32,
    cross_fade: f64,
    duration: f64,
    until_rest: f64,
    peak: f64,
}

impl Correction {
    pub(crate) fn of(outcome: RetuneOutcome) -> Result<Self, Status> {
        match outcome {
            RetuneOutcome::Refused(refusal) => Err(refusal.into()),
            RetuneOutcome::Installed => Ok(Self {
                installed: 1,
                ..Self::default()
            }),
            RetuneOutcome::Corrected(found) => Ok(Self {
                installed: 0,
                robust: found.robust.into(),
                cross_fade: found.cross_fade,
                duration: found.duration,
                until_rest: found.until_rest,
                peak: found.peaks.worst(),
            }),
        }
    }
}

/// `quell_residual`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct PlainResidual {
    shaped: f64,
    unshaped: f64,
}

impl From<Residual> for PlainResidual {
    fn from(Residual { shaped, unshaped }: Residual) -> Self {
        Self { shaped, unshaped }
    }
}

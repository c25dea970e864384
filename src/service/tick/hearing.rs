//! Whether a joint's measurements arrive, and its position after a silence. Whether it may move is decided by
//! the [gate](super::gate).

use crate::service::contract::{Measured, Quantity};
use crate::service::following::MOVED;

/// The watchdog for a joint's measurements.
#[derive(Clone, Copy, Debug)]
pub struct Watchdog {
    /// Silence after which a joint counts as lost, s.
    pub timeout: f64,
    /// Whether that is a fault. Otherwise only the adaptation pauses.
    pub stops: bool,
}

/// A change of a joint's reception.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// The joint has fallen silent.
    Lost,
    /// It reports its motor side again, at this position, rad.
    Back(f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Heard,
    /// Silent; with the motor side's position, once it is measured again.
    Lost(Option<f64>),
    /// Measured again, with the motor side at this position; the engine has not checked yet whether it was
    /// moved.
    Back(f64),
}

/// Reception of a joint's measurements.
#[derive(Clone, Copy, Debug)]
pub struct Hearing {
    watchdog: Watchdog,
    last: f64,
    state: State,
}

impl Hearing {
    /// A joint that was never measured.
    pub fn new(watchdog: Watchdog) -> Self {
        Self {
            watchdog,
            last: f64::NEG_INFINITY,
            state: State::Heard,
        }
    }

    /// Begins commanding from `now` (s) on, from the present position.
    pub fn begin(&mut self, now: f64) {
        self.last = self.last.max(now);
        self.state = State::Heard;
    }

    /// Takes a measurement of the joint, marked if it is refused.
    pub fn take(&mut self, measured: &Measured) {
        if measured.quantity != Quantity::MotorPosition {
            return;
        }
        // A sample without a number is missing.
        if !measured.value[0].is_finite() {
            return;
        }
        // Only the motor side counts: without it the joint's motion is unknown, whatever else is measured.
        self.last = measured.received;
        if measured.refused {
            return;
        }
        match &mut self.state {
            State::Heard => {}
            State::Lost(position) => *position = Some(measured.value[0]),
            State::Back(position) => *position = measured.value[0],
        }
    }

    /// Checks the time (s); returns a change, once.
    pub fn look(&mut self, now: f64) -> Option<Change> {
        let silent = self.is_silent(now) && self.watchdog.stops;
        match self.state {
            State::Heard | State::Back(_) if silent => {
                self.state = State::Lost(None);
                Some(Change::Lost)
            }
            State::Lost(Some(position)) if !silent => {
                self.state = State::Back(position);
                Some(Change::Back(position))
            }
            _ => None,
        }
    }

    /// Notes that the joint stands where it was left, unless it was lost in the meantime.
    pub fn resume(&mut self) {
        if let State::Back(_) = self.state {
            self.state = State::Heard;
        }
    }

    /// Silence after which the joint counts as not heard, s.
    pub fn timeout(&self) -> f64 {
        self.watchdog.timeout
    }

    /// Time since the motor side was heard, s, at `now` (s).
    pub fn silence(&self, now: f64) -> f64 {
        now - self.last
    }

    /// Whether the motor side has been silent for longer than the watchdog allows, at `now` (s).
    pub fn is_silent(&self, now: f64) -> bool {
        self.silence(now) > self.watchdog.timeout
    }

    /// Whether it is measured, and stands where it was left.
    pub fn is_heard(&self) -> bool {
        self.state == State::Heard
    }

    /// Whether the joint was moved by something else during the silence. `command` (rad) is where it was left.
    pub fn is_displaced(&self, command: f64) -> bool {
        match self.state {
            State::Lost(Some(position)) | State::Back(position) => {
                (position - command).abs() > MOVED
            }
            State::Heard | State::Lost(None) => false,
        }
    }
}

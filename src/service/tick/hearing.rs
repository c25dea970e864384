//! Whether a joint is heard, and where one stands that was not. Whether it may move is the [gate](super::gate)'s.

use crate::service::contract::{Measured, Quantity};
use crate::service::following::MOVED;

/// The watchdog of a joint that is not heard.
#[derive(Clone, Copy, Debug)]
pub struct Watchdog {
    /// Silence after which a joint counts as not heard, s.
    pub timeout: f64,
    /// Whether that is a fault. Otherwise only the adaptation waits.
    pub stops: bool,
}

/// A change of what is heard of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// The joint is not heard any more.
    Lost,
    /// It says again where its motor side stands, rad.
    Back(f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Heard,
    /// Not heard; with the motor side's position, once there is one again.
    Lost(Option<f64>),
    /// Heard again, the motor side at this position; the engine has not yet seen whether it was moved.
    Back(f64),
}

/// Whether a joint is heard.
#[derive(Clone, Copy, Debug)]
pub struct Hearing {
    watchdog: Watchdog,
    last: f64,
    state: State,
}

impl Hearing {
    /// Of a joint that was never heard.
    pub fn new(watchdog: Watchdog) -> Self {
        Self {
            watchdog,
            last: f64::NEG_INFINITY,
            state: State::Heard,
        }
    }

    /// The joint is commanded from `now` (s) on, from where it stands.
    pub fn begin(&mut self, now: f64) {
        self.last = self.last.max(now);
        self.state = State::Heard;
    }

    /// Takes a measurement of the joint, marked where it is refused.
    pub fn take(&mut self, measured: &Measured) {
        if measured.quantity != Quantity::MotorPosition {
            return;
        }
        // Without the motor side nobody knows what a joint does, whatever else of it is heard.
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

    /// Looks at the clock (s); says what has changed, once.
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

    /// The engine has seen that the joint stands where it was left, unless it was lost meanwhile.
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

    /// Whether nothing was heard for longer than the watchdog allows, at `now` (s).
    pub fn is_silent(&self, now: f64) -> bool {
        self.silence(now) > self.watchdog.timeout
    }

    /// Whether it is heard, and stands where it was left.
    pub fn is_heard(&self) -> bool {
        self.state == State::Heard
    }

    /// Whether the joint has been moved by something else while it was not heard. `command` (rad) is
    /// where it was left.
    pub fn is_displaced(&self, command: f64) -> bool {
        match self.state {
            State::Lost(Some(position)) | State::Back(position) => {
                (position - command).abs() > MOVED
            }
            State::Heard | State::Lost(None) => false,
        }
    }
}

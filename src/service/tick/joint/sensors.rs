//! What is measured at the joint: what of it the controller takes, and what it forbids.

use super::JointTick;
use crate::controller::Controller;
use crate::estimators::Sample;
use crate::service::contract::{Measured, Quantity};
use crate::service::following::FOLLOWED;
use crate::service::guard::Fault;
use crate::service::ringing::rings_for;
use crate::service::tick::gate::Cause;
use crate::service::tick::hearing::Change;
use crate::service::tick::messages::Event;
use crate::signal::{DeformationSensor, Measurement};

impl JointTick {
    /// Installs a registered sensor; returns the one before.
    pub fn take_sensor(&mut self, mut sensor: Box<DeformationSensor>) -> Option<Event> {
        self.registered = true;
        if let Some(controller) = self.controller.as_deref_mut() {
            // Plain numbers: a copy does not allocate.
            *sensor = controller.replace_sensor((*sensor).clone());
        }
        // The next controller uses it; it must not be dropped here.
        Some(Event::Sensor(sensor))
    }

    /// Takes a measurement; marks it if it is refused.
    pub fn measure(&mut self, measured: &mut Measured) {
        measured.refused = !self.guard.admits(measured, self.motion);
        self.hearing.take(measured);
        if measured.quantity == Quantity::MotorPosition && !measured.refused {
            self.following.take(measured);
        }
        let measurement = match measurement(measured) {
            Some(measurement) if !measured.refused => measurement,
            _ => return,
        };
        if measured.quantity == Quantity::TipPosition && !self.registered {
            return;
        }
        if self.inbox.len() < self.inbox.capacity() {
            self.inbox.push(measurement);
        }
    }

    /// Hands the new measurements to the controller.
    pub fn listen(&mut self, now: f64) {
        let silent = self.hearing.is_silent(now);
        let Some(controller) = self.controller.as_deref_mut() else {
            return;
        };
        let frozen = silent || self.guard.report().is_at_fault();
        if frozen && !self.frozen {
            // Earlier samples belong to a fault, or to another stretch of time.
            controller.restart_estimation();
        }
        self.frozen = frozen;
        self.quiet = is_quiet(controller, self.settled, now);
        controller.set_adaptive(self.adaptive && !frozen && !self.quiet);
        controller.observe(&self.inbox);
        self.inbox.clear();
    }

    /// The samples of its deformation since they were last handed on.
    pub fn heard(&self) -> &[Sample] {
        let controller = self.controller.as_deref();
        controller.map_or(&[], |controller| controller.axis().heard())
    }

    /// Clears the samples after they were handed on.
    pub fn clear_heard(&mut self) {
        if let Some(controller) = self.controller.as_deref_mut() {
            controller.clear_samples();
        }
    }

    /// Checks for a change of the joint's reception; reports it once.
    pub fn look(&mut self, now: f64) -> Option<Event> {
        self.controller.as_ref()?;
        Some(match self.hearing.look(now)? {
            Change::Lost => Event::Lost(self.index),
            Change::Back(position) => Event::Back(self.index, position),
        })
    }

    /// Notes that it stands where it was left before the silence.
    pub fn resume(&mut self) {
        self.hearing.resume();
    }

    /// The fault that forbids moves, except silence, which [`look`](Self::look) reports. A reading that is no number
    /// is silence.
    pub fn fault(&self) -> Option<Cause> {
        self.controller.as_ref()?;
        let sensor = self.guard.report().fault_of(Quantity::MotorPosition);
        let sensor = sensor.filter(|&fault| fault != Fault::NotFinite);
        let following = || self.following.excess().map(Cause::Following);
        sensor.map(Cause::Sensor).or_else(following)
    }

    /// Discards the readings of its sensors.
    pub fn forget(&mut self) {
        self.guard.restart();
        self.following.forgive();
    }

    /// Whether the joint is not where it was left before the silence. Nothing is sent to it then: a setpoint
    /// would be a jump.
    pub fn is_displaced(&self, now: f64) -> bool {
        let rests = self.settled.is_some_and(|since| now - since > FOLLOWED);
        rests && self.hearing.is_displaced(self.sent.position)
    }

    /// Whether its motor side sends at `now` (s), and what it sends is no number.
    pub fn sends_no_number(&self, now: f64) -> bool {
        let sensor = self.guard.report().without_number(Quantity::MotorPosition);
        sensor.is_some_and(|sensor| now - sensor.heard < 0.5 * self.hearing.timeout())
    }

    /// Time since the last measurement, s, and its largest allowed value.
    pub fn silence(&self, now: f64) -> [f64; 2] {
        [self.hearing.silence(now), self.hearing.timeout()]
    }
}

/// Whether nothing moves or vibrates any more, so that only noise is measured.
fn is_quiet(controller: &Controller, settled: Option<f64>, now: f64) -> bool {
    let Some(settled) = settled else {
        return false;
    };
    let mode = controller.axis().status().shaped_for.mode;
    now - settled > rings_for(mode)
}

/// The measurement for the controller, which does not use accelerations.
fn measurement(measured: &Measured) -> Option<Measurement> {
    let (time, value) = (measured.stamp, measured.value);
    Some(match measured.quantity {
        Quantity::MotorPosition => Measurement::MotorPosition {
            time,
            position: value[0],
        },
        Quantity::LinkPosition => Measurement::LinkPosition {
            time,
            position: value[0],
        },
        Quantity::Deformation => Measurement::Deformation {
            time,
            deformation: value[0],
        },
        Quantity::TipPosition => Measurement::TipPosition {
            time,
            position: value,
        },
        Quantity::TipAcceleration => return None,
    })
}

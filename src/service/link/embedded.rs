//! The simulated arm as a robot in real time: one step of it a tick.

use quell_shapers::Setpoint;

use super::RobotLink;
use crate::plant::{ArmSimulation, Command, Load};
use crate::service::contract::{LinkHealth, Measured, Quantity};
use crate::signal::Measurement;

/// The simulated arm. Its time is that of its steps: where ticks are left out it stands still too, as
/// the command does.
pub struct EmbeddedLink {
    arm: ArmSimulation,
    period: f64,
    command: Command,
    counters: LinkHealth,
}

impl EmbeddedLink {
    /// An arm at rest, stepped by `period` (s) a tick.
    pub fn new(arm: ArmSimulation, period: f64) -> Self {
        Self {
            command: Command {
                position: arm.true_motor_position(),
                velocity: Some(0.0),
            },
            arm,
            period,
            counters: LinkHealth::default(),
        }
    }
}

impl RobotLink for EmbeddedLink {
    fn receive(&mut self, now: f64, inbox: &mut Vec<Measured>) {
        for measurement in self.arm.step(self.command, self.period) {
            self.counters.received += 1;
            if inbox.len() == inbox.capacity() {
                self.counters.overflowed += 1;
                continue;
            }
            inbox.push(measured(measurement, now));
        }
        self.counters.clock_offset_s = Some(self.arm.time() - now);
    }

    fn send(&mut self, _now: f64, joint: usize, setpoint: &Setpoint) {
        if joint == 0 {
            self.command = Command {
                position: setpoint.position,
                velocity: Some(setpoint.velocity),
            };
            self.counters.sent += 1;
        }
    }

    fn counters(&self) -> LinkHealth {
        self.counters
    }

    fn carry(&mut self, load: Load) {
        self.arm.carry(load);
    }
}

fn measured(measurement: &Measurement, received: f64) -> Measured {
    let (quantity, value) = match *measurement {
        Measurement::MotorPosition { position, .. } => {
            (Quantity::MotorPosition, [position, 0.0, 0.0])
        }
        Measurement::LinkPosition { position, .. } => {
            (Quantity::LinkPosition, [position, 0.0, 0.0])
        }
        Measurement::Deformation { deformation, .. } => {
            (Quantity::Deformation, [deformation, 0.0, 0.0])
        }
        Measurement::TipPosition { position, .. } => (Quantity::TipPosition, position),
    };
    Measured {
        received,
        stamp: measurement.time(),
        joint: 0,
        quantity,
        value,
        refused: false,
    }
}

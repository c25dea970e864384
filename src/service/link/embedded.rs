//! The simulated arm as a robot in real time: from setpoint to setpoint, one step for each control period
//! between them.

use quell_shapers::Setpoint;

use super::RobotLink;
use crate::plant::{ArmSimulation, Command, Load};
use crate::service::between::between;
use crate::service::bridged::bridged;
use crate::service::contract::{LinkHealth, Measured, Quantity};
use crate::signal::Measurement;

/// The simulated arm. It follows the stamps of the setpoints: after missed ticks the motion between two
/// setpoints takes longer. A gap that is too long for that stops the arm and its clock.
pub struct EmbeddedLink {
    arm: ArmSimulation,
    period: f64,
    /// The last two setpoints, and the time of the last one, s.
    setpoints: [Setpoint; 2],
    sent: Option<f64>,
    /// Control periods between them.
    periods: u64,
    counters: LinkHealth,
}

impl EmbeddedLink {
    /// An arm at rest, stepped by `period` (s) a tick.
    pub fn new(arm: ArmSimulation, period: f64) -> Self {
        Self {
            setpoints: [Setpoint::at_rest(arm.true_motor_position()); 2],
            arm,
            period,
            sent: None,
            periods: 1,
            counters: LinkHealth::default(),
        }
    }
}

impl RobotLink for EmbeddedLink {
    fn receive(&mut self, now: f64, inbox: &mut Vec<Measured>) {
        let whole = self.periods as f64;
        for step in 1..=self.periods {
            let share = step as f64 / whole;
            let setpoint = between(self.setpoints, share, whole * self.period);
            let command = Command {
                position: setpoint.position,
                velocity: Some(setpoint.velocity),
            };
            for measurement in self.arm.step(command, self.period) {
                self.counters.received += 1;
                if inbox.len() == inbox.capacity() {
                    self.counters.overflowed += 1;
                    continue;
                }
                inbox.push(measured(measurement, now));
            }
        }
        // Until the next setpoint it stays at the last one.
        (self.setpoints[0], self.periods) = (self.setpoints[1], 1);
        self.counters.clock_offset_s = Some(self.arm.time() - now);
    }

    fn carries_time(&self) -> bool {
        true
    }

    fn send(&mut self, now: f64, joint: usize, setpoint: &Setpoint) {
        if joint != 0 {
            return;
        }
        let gone = now - self.sent.replace(now).unwrap_or(now);
        let periods = (gone / self.period).round() as u64;
        self.periods = match periods.saturating_sub(1) <= bridged(self.period) {
            true => periods.max(1),
            false => 1,
        };
        self.setpoints[1] = *setpoint;
        self.counters.sent += 1;
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

//! Measurements of a simulation, collected into a recording.

use super::arm::{ArmSimulation, Command};
use quell_recording::{Channel, Recording, Role};
use quell_signal::Measurement;

/// Collects commands and measurements, each channel on its own clock.
#[derive(Clone, Debug, Default)]
pub struct MeasurementLog {
    command: (Vec<f64>, Vec<f64>),
    motor: (Vec<f64>, Vec<f64>),
    link: (Vec<f64>, Vec<f64>),
    deformation: (Vec<f64>, Vec<f64>),
    tip: (Vec<f64>, [Vec<f64>; 3]),
}

impl MeasurementLog {
    /// An empty log.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a commanded position (rad) that holds at `time` (s, controller's clock).
    pub fn push_command(&mut self, time: f64, position: f64) {
        push(&mut self.command, time, position);
    }

    /// Adds a measurement.
    pub fn push(&mut self, measurement: &Measurement) {
        match *measurement {
            Measurement::MotorPosition { time, position } => push(&mut self.motor, time, position),
            Measurement::LinkPosition { time, position } => push(&mut self.link, time, position),
            Measurement::Deformation { time, deformation } => {
                push(&mut self.deformation, time, deformation);
            }
            Measurement::TipPosition { time, position } => {
                self.tip.0.push(time);
                self.tip
                    .1
                    .iter_mut()
                    .zip(position)
                    .for_each(|(column, x)| column.push(x));
            }
        }
    }

    /// Steps a simulation and adds command and measurements; returns the latter.
    pub fn step<'a>(
        &mut self,
        arm: &'a mut ArmSimulation,
        command: Command,
        period: f64,
    ) -> &'a [Measurement] {
        arm.step(command, period);
        self.push_command(arm.time(), command.position);
        let measurements = arm.last_measurements();
        measurements
            .iter()
            .for_each(|measurement| self.push(measurement));
        measurements
    }

    /// The channels with samples, in the order command, motor, link, deformation, tip, to the resolution of
    /// files.
    pub fn into_recording(self, name: &str) -> Recording {
        let scalar = |role, (time, values): (Vec<f64>, Vec<f64>)| Channel {
            role,
            unit: "rad".to_string(),
            time,
            columns: vec![values],
        };
        let mut channels = vec![
            scalar(Role::CommandPosition, self.command),
            scalar(Role::MotorPosition, self.motor),
            scalar(Role::LinkPosition, self.link),
            scalar(Role::Deformation, self.deformation),
            Channel {
                role: Role::TipPosition,
                unit: "m".to_string(),
                time: self.tip.0,
                columns: self.tip.1.to_vec(),
            },
        ];
        channels.retain(|channel| !channel.time.is_empty());
        Recording {
            name: name.to_string(),
            payload: None,
            channels,
        }
        .to_resolution()
    }
}

fn push(series: &mut (Vec<f64>, Vec<f64>), time: f64, value: f64) {
    series.0.push(time);
    series.1.push(value);
}

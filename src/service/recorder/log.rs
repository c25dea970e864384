//! The samples of one joint, gathered while it moves.

use crate::recording::{Channel, Recording, Role};
use crate::service::contract::{Batch, Quantity};

/// Rows that a channel may have: five minutes at 4 kHz. What comes later is left out.
const MOST_ROWS: usize = 1_200_000;

/// Commands and measurements of one joint from one instant on.
#[derive(Clone, Debug)]
pub struct Log {
    joint: usize,
    from: f64,
    command: (Vec<f64>, Vec<f64>),
    sensors: Vec<Sensor>,
    /// Least of reception minus stamp, s: the sensors' clocks stand so far behind the service's, but
    /// for the delay of the fastest sample.
    behind: f64,
}

#[derive(Clone, Debug)]
struct Sensor {
    quantity: Quantity,
    time: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl Log {
    /// An empty log of a joint (counted from 0), from an instant of the service's clock on, s.
    pub fn new(joint: usize, from: f64) -> Self {
        Self {
            joint,
            from,
            command: Default::default(),
            sensors: Vec::new(),
            behind: f64::INFINITY,
        }
    }

    /// Takes what a batch holds of the joint. Measurements that were refused are left out, and stamps
    /// that do not ascend: they would be no recording.
    pub fn take(&mut self, batch: &Batch) {
        let ticks = batch.ticks.iter();
        for row in ticks.filter(|row| row.joint == self.joint && row.time >= self.from) {
            if follows(&self.command.0, row.time) && row.position.is_finite() {
                self.command.0.push(row.time);
                self.command.1.push(row.position);
            }
        }
        for one in &batch.measured {
            if one.joint == self.joint && !one.refused && one.received >= self.from {
                self.behind = self.behind.min(one.received - one.stamp);
                let count = role(one.quantity).1;
                self.sensor(one.quantity)
                    .push(one.stamp, &one.value[..count]);
            }
        }
    }

    /// Whether it holds as much as it may.
    pub fn is_full(&self) -> bool {
        self.command.0.len() >= MOST_ROWS
    }

    /// From the first to the last command, s.
    pub fn duration(&self) -> f64 {
        match (self.command.0.first(), self.command.0.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// The recording, its time counted from the first command. All sensors are shifted by one number,
    /// so that what their clocks say of one another stays.
    pub fn into_recording(self, name: &str, payload: Option<f64>) -> Recording {
        let origin = self.command.0.first().copied().unwrap_or(self.from);
        let command = Channel {
            role: Role::CommandPosition,
            unit: "rad".into(),
            time: self.command.0.iter().map(|time| time - origin).collect(),
            columns: vec![self.command.1],
        };
        let shift = self.behind - origin;
        let sensors = self.sensors.into_iter().map(|sensor| {
            let (role, _, unit) = role(sensor.quantity);
            Channel {
                role,
                unit: unit.into(),
                time: sensor.time.iter().map(|stamp| stamp + shift).collect(),
                columns: sensor.columns,
            }
        });
        let mut channels: Vec<_> = [command].into_iter().chain(sensors).collect();
        channels.retain(|channel| !channel.time.is_empty());
        Recording {
            name: name.into(),
            payload: payload.map(|mass| format!("{mass} kg")),
            channels,
        }
    }

    fn sensor(&mut self, quantity: Quantity) -> &mut Sensor {
        let known = self.sensors.iter().position(|one| one.quantity == quantity);
        let index = known.unwrap_or_else(|| {
            self.sensors.push(Sensor {
                quantity,
                time: Vec::new(),
                columns: vec![Vec::new(); role(quantity).1],
            });
            self.sensors.len() - 1
        });
        &mut self.sensors[index]
    }
}

impl Sensor {
    fn push(&mut self, stamp: f64, values: &[f64]) {
        let finite = stamp.is_finite() && values.iter().all(|value| value.is_finite());
        if finite && follows(&self.time, stamp) {
            self.time.push(stamp);
            let columns = self.columns.iter_mut().zip(values);
            columns.for_each(|(column, &value)| column.push(value));
        }
    }
}

/// Whether a stamp may stand next.
fn follows(time: &[f64], stamp: f64) -> bool {
    time.len() < MOST_ROWS && time.last().is_none_or(|&last| stamp > last)
}

/// Role, number of columns and unit of a quantity.
fn role(quantity: Quantity) -> (Role, usize, &'static str) {
    match quantity {
        Quantity::MotorPosition => (Role::MotorPosition, 1, "rad"),
        Quantity::LinkPosition => (Role::LinkPosition, 1, "rad"),
        Quantity::Deformation => (Role::Deformation, 1, "rad"),
        Quantity::TipPosition => (Role::TipPosition, 3, "m"),
        Quantity::TipAcceleration => (Role::TipAcceleration, 3, "m/s^2"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::service::contract::{Measured, TickRow};

    #[test]
    fn clocks_of_sensors_keep_their_distance() {
        let tick = |time| TickRow {
            time,
            position: time,
            ..TickRow::default()
        };
        let measured = |quantity, received, stamp, refused| Measured {
            received,
            stamp,
            joint: 0,
            quantity,
            value: [1.0; 3],
            refused,
        };
        let batch = Batch {
            ticks: vec![tick(9.0), tick(10.0), tick(10.5), tick(10.5), tick(11.0)],
            measured: vec![
                measured(Quantity::MotorPosition, 10.02, 510.0, false),
                measured(Quantity::TipPosition, 10.06, 510.01, false),
                measured(Quantity::MotorPosition, 10.1, 510.0, false),
                measured(Quantity::MotorPosition, 10.2, 510.2, true),
            ],
            ..Batch::default()
        };
        let mut log = Log::new(0, 10.0);
        log.take(&batch);
        assert_eq!(log.duration(), 1.0);
        let recording = log.into_recording("a", Some(0.5));
        let time = |role| recording.channel(role).unwrap().time.clone();
        assert_eq!(time(Role::CommandPosition), [0.0, 0.5, 1.0]);
        let (motor, tip) = (time(Role::MotorPosition), time(Role::TipPosition));
        assert_eq!((motor.len(), tip.len()), (1, 1));
        assert!((motor[0] - 0.02).abs() < 1e-9 && (tip[0] - motor[0] - 0.01).abs() < 1e-9);
        assert_eq!(recording.payload.as_deref(), Some("0.5 kg"));
    }
}

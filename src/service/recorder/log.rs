//! The samples of one joint during a recording.

use std::path::Path;

use super::known::Known;
use crate::recording::{Channel, McapWriter, Recording, RecordingError, Role, Sink, to_resolution};
use crate::service::contract::{Batch, JointSnapshot, Measured, Quantity};

/// Most rows of a channel: five minutes at 4 kHz. Later ones are dropped.
const MOST_ROWS: usize = 1_200_000;

/// Nearest stamps of a channel, s: files hold nanoseconds, and two stamps that are two apart stay apart,
/// however they are rounded.
const NEAREST: f64 = 2e-9;

/// Range of wall times for the start of a file, seconds since 1970: a day within the range of ROS 2 stamps. A
/// clock that is wrong by decades must not cost the recording.
const FIRST_DAY: f64 = 86_400.0;
const LAST_DAY: f64 = i32::MAX as f64 - 86_400.0;

/// Commands and measurements of one joint from one instant on.
#[derive(Clone, Debug)]
pub struct Log {
    joint: usize,
    from: f64,
    command: Command,
    sensors: Vec<Sensor>,
    /// Modes and trains during the recording.
    known: Known,
    /// Least value of reception minus stamp, s: the lag of the sensors' clocks behind the service's, up to the
    /// delay of the fastest sample.
    behind: f64,
}

/// Part of a log that is already in a file, and the origin of its times there.
pub struct Written {
    origin: f64,
    behind: f64,
    commands: usize,
    /// By sensor.
    samples: Vec<usize>,
    /// Number of changes of the knowledge about the joint.
    known: usize,
}

#[derive(Clone, Debug, Default)]
struct Command {
    time: Vec<f64>,
    /// Position, velocity, acceleration.
    state: Vec<[f64; 3]>,
}

#[derive(Clone, Debug)]
struct Sensor {
    quantity: Quantity,
    received: Vec<f64>,
    time: Vec<f64>,
    columns: Vec<Vec<f64>>,
}

impl Log {
    /// An empty log of a joint (counted from 0), from an instant of the service's clock on, s.
    pub fn new(joint: usize, from: f64) -> Self {
        Self {
            joint,
            from,
            command: Command::default(),
            sensors: Vec::new(),
            known: Known::default(),
            behind: f64::INFINITY,
        }
    }

    /// Adds a batch's data of the joint. Refused measurements and stamps that do not increase are left out,
    /// since they would be an invalid recording. Values are taken to the resolution of files.
    pub fn take(&mut self, batch: &Batch) {
        let ticks = batch.ticks.iter();
        for row in ticks.filter(|row| row.joint == self.joint && row.time >= self.from) {
            let state = [row.position, row.velocity, row.acceleration];
            if follows(&self.command.time, row.time) && state.iter().all(|value| value.is_finite())
            {
                self.command.time.push(row.time);
                self.command.state.push(state.map(to_resolution));
            }
        }
        for one in &batch.measured {
            if one.joint == self.joint && !one.refused && one.received >= self.from {
                self.behind = self.behind.min(one.received - one.stamp);
                self.sensor(one.quantity).push(one);
            }
        }
    }

    /// Adds the knowledge about the joint at `time`, s on the service's clock.
    pub fn know(&mut self, time: f64, joint: &JointSnapshot) {
        self.known.take(time.max(self.from), joint);
    }

    /// Whether it has commands, and measurements that determine the clocks' offset.
    pub fn is_measured(&self) -> bool {
        !self.command.time.is_empty() && self.behind.is_finite()
    }

    /// Whether it has reached its largest size.
    pub fn is_full(&self) -> bool {
        self.command.time.len() >= MOST_ROWS
    }

    /// Whether the command does not stand still.
    pub fn is_moving(&self) -> bool {
        let last = self.command.state.last();
        last.is_some_and(|[_, velocity, acceleration]| *velocity != 0.0 || *acceleration != 0.0)
    }

    /// From the first to the last command, s.
    pub fn duration(&self) -> f64 {
        match (self.command.time.first(), self.command.time.last()) {
            (Some(first), Some(last)) => last - first,
            _ => 0.0,
        }
    }

    /// The recording, with times from the first command on. All sensors are shifted by the same number, so that
    /// their relative times do not change.
    pub fn recording(&self, name: &str, payload: Option<f64>) -> Recording {
        let origin = self.origin();
        let position = self.command.state.iter().map(|state| state[0]);
        let command = Channel {
            role: Role::CommandPosition,
            unit: "rad".into(),
            time: self.command.time.iter().map(|time| time - origin).collect(),
            columns: vec![position.collect()],
        };
        let shift = self.behind - origin;
        let sensors = self.sensors.iter().map(|sensor| {
            let (role, _, unit) = role(sensor.quantity);
            Channel {
                role,
                unit: unit.into(),
                time: sensor.time.iter().map(|stamp| stamp + shift).collect(),
                columns: sensor.columns.clone(),
            }
        });
        let mut channels: Vec<_> = [command].into_iter().chain(sensors).collect();
        channels.retain(|channel| !channel.time.is_empty());
        Recording {
            name: name.into(),
            payload: payload.map(|mass| format!("{mass} kg")),
            channels,
        }
        .to_resolution()
    }

    /// The same as an MCAP file, in the order of events. `path` is for errors; `epoch` is the wall time at
    /// which the service's clock was 0, seconds since 1970.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn write_mcap(
        &self,
        file: Sink,
        path: &Path,
        joint: &str,
        epoch: f64,
    ) -> Result<(), RecordingError> {
        let mut file = self.begin_mcap(file, path, joint, epoch)?;
        let mut written = self.nothing_written();
        self.write_on(&mut written, &mut file, joint)?;
        // What came after the last command: all of it where a joint is not commanded any more.
        let clocks = (written.origin, written.behind);
        for (sensor, next) in self.sensors.iter().zip(written.samples) {
            (next..sensor.time.len())
                .try_for_each(|index| sensor.write(index, &mut file, joint, clocks))?;
        }
        file.finish()
    }

    /// An empty MCAP file.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn begin_mcap(
        &self,
        file: Sink,
        path: &Path,
        joint: &str,
        epoch: f64,
    ) -> Result<McapWriter, RecordingError> {
        let wall = (epoch + self.origin()).clamp(FIRST_DAY, LAST_DAY);
        let wall = (wall * 1e9).round() as i64;
        McapWriter::on(file, path, &[joint], wall)
    }

    /// The state of a new file.
    pub fn nothing_written(&self) -> Written {
        Written {
            origin: self.origin(),
            behind: self.behind,
            commands: 0,
            samples: Vec::new(),
            known: 0,
        }
    }

    /// Writes the data that are not yet in a file, up to the last command.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be written.
    pub fn write_on(
        &self,
        written: &mut Written,
        file: &mut McapWriter,
        joint: &str,
    ) -> Result<(), RecordingError> {
        let clocks = (written.origin, written.behind);
        written.samples.resize(self.sensors.len(), 0);
        let commands = self.command.time.iter().zip(&self.command.state);
        for (&time, &[position, velocity, acceleration]) in commands.skip(written.commands) {
            for (sensor, next) in self.sensors.iter().zip(&mut written.samples) {
                while sensor
                    .received
                    .get(*next)
                    .is_some_and(|&received| received <= time)
                {
                    sensor.write(*next, file, joint, clocks)?;
                    *next += 1;
                }
            }
            let now = (time, clocks.0);
            self.known.write_on(&mut written.known, now, file, joint)?;
            file.write_command(time - clocks.0, joint, position, velocity, acceleration)?;
            written.commands += 1;
        }
        Ok(())
    }

    fn origin(&self) -> f64 {
        self.command.time.first().copied().unwrap_or(self.from)
    }

    fn sensor(&mut self, quantity: Quantity) -> &mut Sensor {
        let known = self.sensors.iter().position(|one| one.quantity == quantity);
        let index = known.unwrap_or_else(|| {
            self.sensors.push(Sensor {
                quantity,
                received: Vec::new(),
                time: Vec::new(),
                columns: vec![Vec::new(); role(quantity).1],
            });
            self.sensors.len() - 1
        });
        &mut self.sensors[index]
    }
}

impl Sensor {
    fn push(&mut self, one: &Measured) {
        let stamp = one.stamp;
        let values = &one.value[..self.columns.len()];
        let finite = stamp.is_finite() && values.iter().all(|value| value.is_finite());
        if finite && follows(&self.time, stamp) {
            self.received.push(one.received);
            self.time.push(stamp);
            let columns = self.columns.iter_mut().zip(values);
            columns.for_each(|(column, &value)| column.push(to_resolution(value)));
        }
    }

    /// Writes a sample; times are relative to `origin`, and the sensors' clocks lag by `behind`.
    fn write(
        &self,
        index: usize,
        file: &mut McapWriter,
        joint: &str,
        (origin, behind): (f64, f64),
    ) -> Result<(), RecordingError> {
        let mut values = [0.0; 3];
        let columns = values.iter_mut().zip(&self.columns);
        columns.for_each(|(value, column)| *value = column[index]);
        let (role, count, _) = role(self.quantity);
        let (time, stamp) = (
            self.received[index] - origin,
            self.time[index] + behind - origin,
        );
        file.write_sample(time, joint, role, stamp, &values[..count])
    }
}

/// Whether a stamp may follow.
fn follows(time: &[f64], stamp: f64) -> bool {
    time.len() < MOST_ROWS && time.last().is_none_or(|&last| stamp - last > NEAREST)
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
    use crate::service::contract::TickRow;

    #[test]
    fn clocks_of_sensors_keep_their_distance() {
        let tick = |time| TickRow {
            time,
            position: time + 3e-226,
            velocity: -3e-226,
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
            ticks: vec![
                tick(9.0),
                tick(10.0),
                tick(10.500_000_000_000_002),
                tick(10.5),
                tick(11.0),
            ],
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
        let recording = log.recording("a", Some(0.5));
        let time = |role| recording.channel(role).unwrap().time.clone();
        assert_eq!(time(Role::CommandPosition), [0.0, 0.5, 1.0]);
        let (motor, tip) = (time(Role::MotorPosition), time(Role::TipPosition));
        assert_eq!((motor.len(), tip.len()), (1, 1));
        assert!((motor[0] - 0.02).abs() < 1e-9 && (tip[0] - motor[0] - 0.01).abs() < 1e-9);
        // No file has the rounding of the arithmetic.
        assert_eq!(log.command.state[0], [10.0, 0.0, 0.0]);
        assert!(log.command.state[0][1].is_sign_positive());
        assert_eq!(recording.payload.as_deref(), Some("0.5 kg"));
    }
}

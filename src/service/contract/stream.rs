//! The stream: every tick and every measurement, in batches, with what happened between them.

use serde::Serialize;

use super::MoveResult;

/// Some 20 ms of all data. The live view thins it, the recorder writes all of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    /// Counted up by 1; a gap shows a slow reader what it lost.
    pub number: u64,
    /// When it ended, s on the service's clock. It has no row where no joint is commanded.
    pub time: f64,
    /// One row for each tick and joint, in order of time.
    pub ticks: Vec<TickRow>,
    /// Measurements, in order of arrival.
    pub measured: Vec<Measured>,
    /// Events, in order of time.
    pub events: Vec<Event>,
}

/// One joint at one tick. There is a row also for a missed tick that was made up for, though nothing was sent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TickRow {
    /// Time on the service's clock, s.
    pub time: f64,
    /// The joint, counted from 0.
    pub joint: usize,
    /// Planned, unshaped position, rad.
    pub planned: f64,
    /// Commanded position, rad.
    pub position: f64,
    /// Commanded velocity, rad/s.
    pub velocity: f64,
    /// Commanded acceleration, rad/s^2.
    pub acceleration: f64,
    /// Last deformation, rad; NaN before the first.
    pub deformation: f64,
    /// Stamp of the last deformation, s on the robot's clock.
    pub deformation_time: f64,
    /// Last deformation along the tip's arc, m; NaN where the arc is not known.
    pub tip_deformation: f64,
    /// Estimated natural frequency, rad/s; NaN where there is no estimate.
    pub natural_frequency: f64,
    /// One standard deviation of it, rad/s.
    pub natural_frequency_std: f64,
    /// Estimated damping ratio.
    pub damping_ratio: f64,
    /// One standard deviation of it.
    pub damping_ratio_std: f64,
    /// Whether the estimate has settled.
    pub converged: bool,
    /// Number of the move that runs or ran last.
    pub move_id: u64,
}

/// The quantity that a sensor of a joint measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Motor-side position, rad.
    MotorPosition,
    /// Link position, rad.
    LinkPosition,
    /// Link minus motor, rad.
    Deformation,
    /// Tip in the sensor's own frame, m.
    TipPosition,
    /// Acceleration of the tip in the sensor's own frame, m/s^2.
    TipAcceleration,
}

impl Quantity {
    /// Name in datagrams, recordings and metrics.
    pub fn name(self) -> &'static str {
        match self {
            Self::MotorPosition => "motor_position",
            Self::LinkPosition => "link_position",
            Self::Deformation => "deformation",
            Self::TipPosition => "tip_position",
            Self::TipAcceleration => "tip_acceleration",
        }
    }
}

/// One measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Time of reception, s on the service's clock.
    pub received: f64,
    /// Its stamp on the sensor's own clock, s.
    pub stamp: f64,
    /// The joint, counted from 0.
    pub joint: usize,
    /// The quantity.
    pub quantity: Quantity,
    /// Its value; a scalar is the first component.
    pub value: [f64; 3],
    /// Whether it was refused, and not used for the estimate.
    pub refused: bool,
}

/// An event between two ticks.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
pub enum Event {
    /// A move began.
    MoveStarted(MoveStart),
    /// A move has ended and its vibration has decayed; no more data of it follow.
    MoveEnded(Box<MoveResult>),
}

/// A move that begins.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MoveStart {
    /// Number of the move.
    pub id: u64,
    /// The joint.
    pub joint: String,
    /// The joint, counted from 0.
    pub joint_index: usize,
    /// When it began, s on the service's clock.
    pub time_s: f64,
    /// When it began, seconds since 1970.
    pub unix_time_s: f64,
    /// Where it begins, rad.
    pub from_rad: f64,
    /// Its target, rad.
    pub target_rad: f64,
    /// Shaper, `none` for an unshaped move.
    pub shaper: String,
    /// Name of its recording, if recordings are made. [`MoveResult::recording`] tells whether it is on the
    /// disk.
    pub recording: Option<String>,
}

/// One point of the live view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Frame {
    /// Time on the service's clock, s.
    pub time_s: f64,
    /// The joint, counted from 0.
    pub joint: usize,
    /// Planned, unshaped position, rad.
    pub planned_rad: f64,
    /// Commanded position, rad.
    pub command_rad: f64,
    /// Commanded velocity, rad/s.
    pub command_rad_s: f64,
    /// Last motor position within the batch, rad.
    pub motor_rad: Option<f64>,
    /// Last deformation, rad.
    pub deformation_rad: Option<f64>,
    /// Last deformation along the tip's arc, m.
    pub tip_deformation_m: Option<f64>,
    /// Estimated natural frequency, Hz.
    pub frequency_hz: Option<f64>,
    /// One standard deviation of it, Hz.
    pub frequency_std_hz: Option<f64>,
    /// Number of the move that runs or ran last.
    pub move_id: u64,
}

impl Batch {
    /// The points of the live view: for each joint at most one row every `interval` s, on a grid of the
    /// service's clock, so that successive batches join without a gap.
    pub fn frames(&self, interval: f64) -> Vec<Frame> {
        let slot = |row: &TickRow| (row.time / interval).floor();
        let mut last = Vec::new();
        let mut frames = Vec::new();
        for row in &self.ticks {
            if last.len() <= row.joint {
                last.resize(row.joint + 1, f64::NAN);
            }
            if slot(row) != last[row.joint] {
                last[row.joint] = slot(row);
                frames.push(self.frame(row));
            }
        }
        frames
    }

    fn frame(&self, row: &TickRow) -> Frame {
        let known = |value: f64| value.is_finite().then_some(value);
        let motor = self.measured.iter().rfind(|measured| {
            measured.joint == row.joint
                && measured.quantity == Quantity::MotorPosition
                && measured.received <= row.time
                && measured.value[0].is_finite()
        });
        Frame {
            time_s: row.time,
            joint: row.joint,
            planned_rad: row.planned,
            command_rad: row.position,
            command_rad_s: row.velocity,
            motor_rad: motor.map(|measured| measured.value[0]),
            deformation_rad: known(row.deformation),
            tip_deformation_m: known(row.tip_deformation),
            frequency_hz: known(row.natural_frequency / core::f64::consts::TAU),
            frequency_std_hz: known(row.natural_frequency_std / core::f64::consts::TAU),
            move_id: row.move_id,
        }
    }
}

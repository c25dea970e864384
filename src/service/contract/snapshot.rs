//! The state of everything now, for `GET /api/v1/state`, `GET /api/v1/estimates` and `GET /metrics`.

use std::net::SocketAddr;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{DiskView, EnableView, JointMap, KnownMode, LearningView, ModeValue};

/// The state of everything now. Published some 20 times a second.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Snapshot {
    /// Version of the service.
    pub version: &'static str,
    /// The robot: `embedded`, `udp`, `zenoh`.
    pub robot: &'static str,
    /// Seconds since 1970 when this was published, by the system's clock.
    pub unix_time_s: f64,
    /// Time on the service's clock, s since it started: that of the stream.
    pub time_s: f64,
    /// Whether the service is bringing the robot to rest in order to end.
    pub stopping: bool,
    /// Whether moves may begin, and why not.
    pub enable: EnableView,
    /// Share of full speed at which moves are planned, percent.
    pub feed_percent: f64,
    /// Payload, kg; absent for another robot than the embedded arm as long as none was declared.
    pub payload_kg: Option<f64>,
    /// One entry a joint.
    pub joints: Vec<JointSnapshot>,
    /// How well the tick is kept.
    pub tick: TickStatistics,
    /// Counts of the link's messages.
    pub link: LinkHealth,
    /// How it goes with the data folder.
    pub disk: DiskView,
    /// The last moves, oldest first; at most 64.
    pub moves: Vec<MoveResult>,
}

/// One joint now.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct JointSnapshot {
    /// Name.
    pub name: String,
    /// The joint's phase.
    pub phase: Phase,
    /// Number of the move that runs or ran last; 0 before the first.
    pub move_id: u64,
    /// Where the present or last plan ends, rad.
    pub target_rad: f64,
    /// Planned, unshaped position, rad.
    pub planned_rad: f64,
    /// Commanded position, rad.
    pub command_rad: f64,
    /// Commanded velocity, rad/s.
    pub command_rad_s: f64,
    /// Last measured motor position, rad.
    pub motor_rad: Option<f64>,
    /// Distance of the motor side from all that was commanded in the 0.06 s in which it follows, rad.
    pub following_error_rad: Option<f64>,
    /// Following error from which on it is a fault, rad.
    pub following_limit_rad: f64,
    /// Last deformation, rad.
    pub deformation_rad: Option<f64>,
    /// The same along the tip's arc, m, where the arc is known.
    pub tip_deformation_m: Option<f64>,
    /// Lowest and highest position that a move may have as its target, rad.
    pub range_rad: [f64; 2],
    /// Limits of velocity (rad/s), acceleration (rad/s^2) and jerk (rad/s^3).
    pub limits: [f64; 3],
    /// Whether any of them is only that of the embedded arm, nothing having been said of this robot's.
    pub limits_assumed: bool,
    /// Whether the range is only a turn either way, nothing having been said of this robot's.
    pub range_assumed: bool,
    /// Whether a sensor of the tip speaks whose frame is not known yet: the first moves tell it.
    pub awaits_registration: bool,
    /// Whether plans are shaped.
    pub shaping: bool,
    /// Whether the train follows the estimate.
    pub adaptation: bool,
    /// Whether the adaptation waits, as after the watchdog or a sensor fault.
    pub adaptation_frozen: bool,
    /// Name of the shaper.
    pub shaper: &'static str,
    /// The mode that the train in force is designed for.
    pub mode: Option<ModeValue>,
    /// Since when it is in force, `unix_time_s`.
    pub mode_since_s: f64,
    /// The train in force.
    pub train: TrainView,
    /// The estimator's present estimate.
    pub estimate: Option<EstimateView>,
    /// Truth of the embedded arm, to compare the estimate with; absent for another robot.
    pub true_mode: Option<ModeValue>,
    /// Trains changed because of an estimate since the start.
    pub retunes: u64,
    /// Corrections in motion since the start.
    pub corrections: u64,
    /// Corrections that were refused because none kept the limits, since the start.
    pub corrections_refused: u64,
    /// The watchdog.
    pub watchdog: WatchdogState,
    /// The joint's sensors.
    pub sensors: Vec<SensorView>,
    /// What its moves have taught.
    pub learning: LearningView,
    /// Its modes over the pose, which is asked for by itself.
    #[serde(skip)]
    pub map: Arc<JointMap>,
}

/// The phase of a joint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// The robot has not yet said where it stands; nothing is commanded.
    #[default]
    Waiting,
    /// The command stands still.
    Rest,
    /// A move runs.
    Moving,
    /// A stop was asked for, or runs.
    Stopping,
}

/// Impulses in force.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct TrainView {
    /// Instants, s after the first.
    pub times_s: Vec<f64>,
    /// Amplitudes, sum 1.
    pub amplitudes: Vec<f64>,
}

impl TrainView {
    /// Labels and sizes of [`Self::numbers`], as `std_msgs/msg/Float64MultiArray` has them.
    pub fn dimensions(&self) -> [(&'static str, usize); 2] {
        [("impulse", self.times_s.len()), ("time_s,amplitude", 2)]
    }

    /// Instant and amplitude of each impulse.
    pub fn numbers(&self) -> Vec<f64> {
        let impulses = self.times_s.iter().zip(&self.amplitudes);
        impulses
            .flat_map(|(time, amplitude)| [*time, *amplitude])
            .collect()
    }
}

/// An estimate and what was made of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct EstimateView {
    /// Time of the last sample used, s on the service's clock.
    pub time_s: f64,
    /// Undamped natural frequency, Hz.
    pub frequency_hz: f64,
    /// One standard deviation of it, Hz.
    pub frequency_std_hz: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// One standard deviation of it.
    pub damping_ratio_std: f64,
    /// Whether the estimate has settled.
    pub converged: bool,
    /// Whether it was taken for the train.
    pub accepted: bool,
    /// Why it was not, in a few words.
    pub refused: Option<String>,
}

/// The state of the watchdog.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WatchdogState {
    /// Measurements come.
    #[default]
    Fine,
    /// None for the configured time: adaptation waits.
    Silent,
    /// None for the configured time on a link that needs feedback: the joint was stopped.
    Stopped,
}

/// One sensor of a joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct SensorView {
    /// Its quantity: `motor_position`, `link_position`, `deformation`, `tip_position`,
    /// `tip_acceleration`.
    pub name: &'static str,
    /// Samples taken since the start.
    pub samples: u64,
    /// Samples a second over the last second.
    pub rate_hz: f64,
    /// Seconds since the last one.
    pub age_s: f64,
    /// Samples refused since the start, by reason; reasons that never occurred are left out.
    pub refused: Vec<(&'static str, u64)>,
    /// The fault that it has now: `stuck`, `saturated`, `jump`; `not_finite` where it has sent no number for half a
    /// second. A single one counts as missing.
    pub fault: Option<&'static str>,
}

/// How well the tick is kept, since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct TickStatistics {
    /// Ticks asked for a second, Hz.
    pub rate_hz: f64,
    /// Ticks run.
    pub ticks: u64,
    /// Ticks that had not ended when the next one was due.
    pub overruns: u64,
    /// Ticks left out because the thread came a whole period late or more; the command makes up for
    /// them, or waits where setpoints carry no time ([`pace`](crate::service::tick::pace)).
    pub skipped: u64,
    /// Median lateness of the beginning of a tick, s.
    pub lateness_p50_s: f64,
    /// 99th percentile of it, s.
    pub lateness_p99_s: f64,
    /// Largest, s.
    pub lateness_max_s: f64,
    /// Median and 99th percentile of the work of a tick, s.
    pub work_p50_s: f64,
    /// 99th percentile of the work of a tick, s.
    pub work_p99_s: f64,
    /// Whether the thread has a real-time priority.
    pub real_time: bool,
    /// Whether the memory is locked.
    pub memory_locked: bool,
    /// Records for the stream that found no room, since nobody took them in time.
    pub records_lost: u64,
}

/// Counts of the link's messages, in and out, since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct LinkHealth {
    /// Datagrams received, of whatever kind.
    pub received: u64,
    /// Setpoints sent.
    pub sent: u64,
    /// Setpoints that could not be sent.
    pub send_failures: u64,
    /// Stamps missing in the sequence of a sensor of regular rate when 64 younger have come.
    pub lost: u64,
    /// Datagrams that came later than the watchdog allows.
    pub late: u64,
    /// Datagrams that came twice.
    pub doubled: u64,
    /// Datagrams that came after a younger one.
    pub reordered: u64,
    /// Datagrams from another address than the robot's.
    pub foreign: u64,
    /// Datagrams that are not what they should be.
    pub malformed: u64,
    /// Datagrams for a joint that there is not.
    pub unknown_joint: u64,
    /// Datagrams whose signature is wrong or missing.
    pub unsigned: u64,
    /// Signed datagrams whose number had come before, or is far behind the newest.
    pub replayed: u64,
    /// Measurements for which the tick had no room.
    pub overflowed: u64,
    /// The robot's address, once it is known.
    pub peer: Option<SocketAddr>,
    /// The robot's clock minus the service's, s, by the datagrams of least delay.
    pub clock_offset_s: Option<f64>,
}

/// Why a move ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MoveEnd {
    /// It went to its target.
    #[default]
    Target,
    /// Another move took over before its end.
    Replaced,
    /// It was stopped: by a request, the end of a hold, the feed or the end of the service.
    Stopped,
    /// A fault stopped it.
    Fault,
}

/// The result of a move.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MoveResult {
    /// Number of the move.
    pub id: u64,
    /// The joint.
    pub joint: String,
    /// When it began, seconds since 1970.
    pub unix_time_s: f64,
    /// Where it began, rad.
    pub from_rad: f64,
    /// Where it ended, rad.
    pub target_rad: f64,
    /// From its first tick to the last change of the command, s.
    pub duration_s: f64,
    /// Shaper, `none` for an unshaped move.
    pub shaper: String,
    /// Whether a train was in force.
    pub shaped: bool,
    /// Whether the train followed the estimate.
    pub adaptive: bool,
    /// Whether it was stopped or given another target before its end.
    pub interrupted: bool,
    /// Why it ended; absent in the file of an earlier version.
    #[serde(default)]
    pub ended: Option<MoveEnd>,
    /// The fault that ended it, in a sentence.
    #[serde(default)]
    pub fault: Option<String>,
    /// Mode of the train in force at its end.
    pub mode: Option<ModeValue>,
    /// Payload as it was declared, kg.
    pub payload_kg: Option<f64>,
    /// Amplitude of the deformation that was left after the command had ended, rad; absent where too
    /// little was measured.
    pub residual_rad: Option<f64>,
    /// The same along the tip's arc, m.
    pub residual_m: Option<f64>,
    /// Residual of the same plan unshaped, in the mode known best, rad. For an unshaped move
    /// the measured residual itself.
    pub unshaped_rad: Option<f64>,
    /// The same along the tip's arc, m.
    pub unshaped_m: Option<f64>,
    /// Largest amplitude of the deformation in the whole move, in cruise and after the command has ended, rad.
    pub vibration_rad: Option<f64>,
    /// The same along the tip's arc, m.
    pub vibration_m: Option<f64>,
    /// Vibration of the same plan unshaped in the whole move, rad, as `unshaped_rad`.
    pub unshaped_vibration_rad: Option<f64>,
    /// The same along the tip's arc, m.
    pub unshaped_vibration_m: Option<f64>,
    /// One standard deviation of `unshaped_rad` and `unshaped_vibration_rad` of a shaped move, rad, from the modes: both hold for
    /// a motor side that follows exactly, and how it follows is not in it. Where two of them are as much as the value, nothing is
    /// known of that. Absent where the modes do not explain the move.
    pub unshaped_std_rad: Option<f64>,
    /// The modes known on its way when it had ended.
    #[serde(default)]
    pub modes: Vec<KnownMode>,
    /// Name of its recording, which is on the disk, whole or growing. Absent where none is, or not yet.
    pub recording: Option<String>,
}

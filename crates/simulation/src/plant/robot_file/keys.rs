//! The keys of a robot description, as written.

use std::path::PathBuf;

use quell_recording::exactly;
use serde::Deserialize;

use crate::plant::robot::Damping;

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotFile {
    /// Name of the machine.
    pub name: String,
    /// URDF file with the kinematics and masses, relative to this file. Without it each joint has `dh`.
    pub urdf: Option<PathBuf>,
    /// Link of the URDF that ends the chain; that of the longest chain where absent.
    pub tip_link: Option<String>,
    /// The point that the tracker sees.
    #[serde(default)]
    pub tool: PoseKeys,
    /// The default move.
    #[serde(rename = "move")]
    pub default_move: MoveKeys,
    /// The controller.
    pub controller: ControllerKeys,
    /// The servo.
    pub servo: ServoKeys,
    /// The sensor of the motor side.
    pub encoder: EncoderKeys,
    /// The sensor of the tip.
    pub tracker: TrackerKeys,
    /// The joints.
    pub joint: Vec<JointKeys>,
}

/// `[tool]`: the point that the tracker sees, from the last joint or from `tip_link`.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct PoseKeys {
    /// Position, m.
    #[serde(default, deserialize_with = "exactly")]
    pub position_m: [f64; 3],
    /// Roll, pitch and yaw, deg.
    #[serde(default, deserialize_with = "exactly")]
    pub rpy_deg: [f64; 3],
}

/// `[move]`: the move that `quell move` makes by default.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MoveKeys {
    /// The joint that moves, counted from 1.
    pub joint: usize,
    /// How far, deg.
    pub target_deg: f64,
}

/// `[controller]`: the controller of the robot.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerKeys {
    /// Setpoints a second, Hz, above 0 and at most 1e6.
    pub rate_hz: f64,
}

/// `[servo]`: how the motor side follows its command: a second-order low-pass filter.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoKeys {
    /// Natural frequency, Hz, above 0 and at most 1e6.
    pub bandwidth_hz: f64,
    /// Damping ratio, above 0.
    pub damping_ratio: f64,
    /// Share of the velocity that is fed forward: 1 follows a ramp without lag.
    pub velocity_feed_forward: f64,
}

/// `[encoder]`: the sensor of the motor side.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EncoderKeys {
    /// Samples a second, Hz, above 0 and at most 1e6.
    pub rate_hz: f64,
    /// Step of the reading, rad; 0 rounds nothing.
    pub resolution_rad: f64,
}

/// `[tracker]`: the sensor of the tip.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrackerKeys {
    /// Samples a second, Hz, above 0 and at most 1e6.
    pub rate_hz: f64,
    /// Standard deviation of its noise, um.
    pub noise_um: f64,
    /// Where it stands, in the robot's base frame, m.
    #[serde(deserialize_with = "exactly")]
    pub position_m: [f64; 3],
    /// Roll, pitch and yaw of its frame, deg.
    #[serde(deserialize_with = "exactly")]
    pub rpy_deg: [f64; 3],
    /// What its clock reads when that of the controller reads 0, s.
    #[serde(default)]
    pub clock_offset_s: f64,
    /// How much faster its clock runs, parts per million, above -1e6.
    #[serde(default)]
    pub clock_skew_ppm: f64,
}

/// `[[joint]]`: one joint, from the base to the tip.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointKeys {
    /// Name; with a URDF file the joint's name there.
    pub name: Option<String>,
    /// Its row of Denavit and Hartenberg; not with a URDF file.
    pub dh: Option<DhKeys>,
    /// Home position of a joint that turns, deg; 0 where absent.
    pub home_deg: Option<f64>,
    /// Home position of a joint that slides, m; 0 where absent.
    pub home_m: Option<f64>,
    /// What it may do.
    pub limits: LimitKeys,
    /// Its vibratory modes; it is rigid without any.
    #[serde(default)]
    pub mode: Vec<ModeKeys>,
    /// The body behind it; not with a URDF file.
    pub link: Option<LinkKeys>,
}

/// `dh` of a joint: a row of Denavit and Hartenberg, `Rz(theta + q) Tz(d) Tx(a) Rx(alpha)`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DhKeys {
    /// Length along x, m.
    pub a_m: f64,
    /// Twist about x, deg.
    pub alpha_deg: f64,
    /// Offset along z, m.
    pub d_m: f64,
    /// Angle about z, deg.
    pub theta_deg: f64,
    /// Whether the joint adds to `d` instead of `theta`.
    #[serde(default)]
    pub slides: bool,
}

/// `limits` of a joint. Keys in deg are for joints that turn, keys in m for joints that slide; all three are needed.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitKeys {
    /// Velocity, deg/s, above 0.
    pub velocity_deg_s: Option<f64>,
    /// Acceleration, deg/s^2, above 0.
    pub acceleration_deg_s2: Option<f64>,
    /// Jerk, deg/s^3, above 0.
    pub jerk_deg_s3: Option<f64>,
    /// Velocity, m/s, above 0.
    pub velocity_m_s: Option<f64>,
    /// Acceleration, m/s^2, above 0.
    pub acceleration_m_s2: Option<f64>,
    /// Jerk, m/s^3, above 0.
    pub jerk_m_s3: Option<f64>,
}

/// `mode` of a joint, at most four: a vibratory mode in the home pose, without payload.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModeKeys {
    /// Natural frequency, Hz, above 0 and at most 1e6.
    pub frequency_hz: f64,
    /// Damping ratio, 0 or more, below 1.
    pub damping_ratio: f64,
    /// Where the damper sits: `across_joint` or `to_ground`.
    pub damping: Damping,
    /// Share of this mode in the deflection of the tip.
    #[serde(default = "one")]
    pub participation: f64,
}

/// `link` of a joint: the body behind it. Modes follow pose and payload by the masses.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkKeys {
    /// Mass, kg, 0 or more.
    pub mass_kg: f64,
    /// Centre of mass in the joint's frame, m.
    #[serde(deserialize_with = "exactly")]
    pub centre_m: [f64; 3],
    /// Principal moments of inertia about the centre, kg m^2, 0 or more.
    #[serde(default, deserialize_with = "exactly")]
    pub inertia_kg_m2: [f64; 3],
}

fn one() -> f64 {
    1.0
}

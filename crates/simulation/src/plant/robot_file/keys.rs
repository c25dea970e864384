//! The keys of a robot description, as written.

use std::path::PathBuf;

use serde::Deserialize;

use crate::plant::robot::Damping;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotFile {
    pub name: String,
    pub urdf: Option<PathBuf>,
    pub tip_link: Option<String>,
    #[serde(default)]
    pub tool: PoseKeys,
    #[serde(rename = "move")]
    pub default_move: MoveKeys,
    pub controller: ControllerKeys,
    pub servo: ServoKeys,
    pub encoder: EncoderKeys,
    pub tracker: TrackerKeys,
    pub joint: Vec<JointKeys>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub struct PoseKeys {
    #[serde(default)]
    pub position_m: [f64; 3],
    #[serde(default)]
    pub rpy_deg: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MoveKeys {
    pub joint: usize,
    pub target_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControllerKeys {
    pub rate_hz: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoKeys {
    pub bandwidth_hz: f64,
    pub damping_ratio: f64,
    pub velocity_feed_forward: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EncoderKeys {
    pub rate_hz: f64,
    pub resolution_rad: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrackerKeys {
    pub rate_hz: f64,
    pub noise_um: f64,
    pub position_m: [f64; 3],
    pub rpy_deg: [f64; 3],
    #[serde(default)]
    pub clock_offset_s: f64,
    #[serde(default)]
    pub clock_skew_ppm: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointKeys {
    pub name: Option<String>,
    pub dh: Option<DhKeys>,
    pub home_deg: Option<f64>,
    pub home_m: Option<f64>,
    pub limits: LimitKeys,
    #[serde(default)]
    pub mode: Vec<ModeKeys>,
    pub link: Option<LinkKeys>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DhKeys {
    pub a_m: f64,
    pub alpha_deg: f64,
    pub d_m: f64,
    pub theta_deg: f64,
    #[serde(default)]
    pub slides: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LimitKeys {
    pub velocity_deg_s: Option<f64>,
    pub acceleration_deg_s2: Option<f64>,
    pub jerk_deg_s3: Option<f64>,
    pub velocity_m_s: Option<f64>,
    pub acceleration_m_s2: Option<f64>,
    pub jerk_m_s3: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModeKeys {
    pub frequency_hz: f64,
    pub damping_ratio: f64,
    pub damping: Damping,
    #[serde(default = "one")]
    pub participation: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkKeys {
    pub mass_kg: f64,
    pub centre_m: [f64; 3],
    #[serde(default)]
    pub inertia_kg_m2: [f64; 3],
}

fn one() -> f64 {
    1.0
}

//! The keys of `quell.toml`, each with its unit and default, before they are checked.

use std::net::SocketAddr;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::{Deserialize, Deserializer};

use super::recording::RecordingKeys;
use super::{NatsConfig, RobotKind, ZenohConfig};
use crate::estimators::ESTIMATORS;
use crate::recording::exactly;
use crate::service::shapers;

/// The whole file. Every table may be left out.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Keys {
    pub service: ServiceKeys,
    pub tick: TickKeys,
    pub http: HttpKeys,
    pub udp: UdpKeys,
    pub zenoh: ZenohConfig,
    pub nats: Option<NatsConfig>,
    pub foxglove: FoxgloveKeys,
    pub watchdog: WatchdogKeys,
    pub recording: RecordingKeys,
    pub diagnosis: DiagnosisKeys,
    pub joint: Vec<JointKeys>,
}

/// `[service]`: what is commanded, and where data are kept.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ServiceKeys {
    /// Which robot.
    #[schemars(extend("enum" = robots()))]
    pub robot: String,
    /// Description of the robot, TOML as for `quell move --robot`; the embedded arm where absent.
    pub description: Option<PathBuf>,
    /// Folder of state and recordings, relative to the working directory.
    pub data: PathBuf,
}

impl Default for ServiceKeys {
    fn default() -> Self {
        Self {
            robot: "embedded".into(),
            description: None,
            data: "quell-data".into(),
        }
    }
}

/// `[tick]`: the control period.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct TickKeys {
    /// Ticks a second, Hz, 250 to 4000.
    #[schemars(range(min = 250.0, max = 4000.0))]
    pub rate_hz: f64,
    /// Whether a real-time priority and locked memory are asked for.
    pub real_time: bool,
}

impl Default for TickKeys {
    fn default() -> Self {
        Self {
            rate_hz: 1000.0,
            real_time: true,
        }
    }
}

/// `[http]`: page and interface.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct HttpKeys {
    /// Where it listens; port 0 takes a free one.
    pub address: SocketAddr,
    /// Token that every request must carry; needed where the address is not loopback.
    pub token: Option<String>,
    /// Most connections at once.
    #[schemars(range(min = 1, max = 10000))]
    pub max_connections: usize,
    /// Longest body of a request, bytes.
    #[schemars(range(min = 256, max = 100000000))]
    pub max_body_bytes: usize,
}

impl Default for HttpKeys {
    fn default() -> Self {
        Self {
            address: SocketAddr::from(([127, 0, 0, 1], 7870)),
            token: None,
            max_connections: 64,
            max_body_bytes: 64 * 1024,
        }
    }
}

/// `[udp]`: the link to a robot that is not embedded.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct UdpKeys {
    /// Where it listens; port 0 takes a free one.
    pub address: SocketAddr,
    /// The robot's address; where absent, and on loopback only, that of its first datagram.
    pub robot: Option<SocketAddr>,
    /// Key that signs datagrams both ways, at least 16 characters; not signed where absent. Needed where the
    /// address is not loopback.
    pub key: Option<String>,
    /// Whether datagrams may go unsigned where the address is not loopback: whoever reaches it can then pass for
    /// the robot.
    pub allow_unsigned: bool,
}

impl Default for UdpKeys {
    fn default() -> Self {
        Self {
            address: SocketAddr::from(([127, 0, 0, 1], 7871)),
            robot: None,
            key: None,
            allow_unsigned: false,
        }
    }
}

/// `[foxglove]`: the live view.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct FoxgloveKeys {
    /// Where it listens, on loopback; port 0 takes a free one. Without it there is none.
    pub address: Option<SocketAddr>,
}

/// `[watchdog]`: what happens when the robot falls silent.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct WatchdogKeys {
    /// Silence of a motor side, and time without ticks in motion, after which there is a fault, s.
    #[schemars(range(min = 0.005, max = 60.0))]
    pub timeout_s: f64,
    /// Whether that is a fault, which stops all joints.
    pub stop: bool,
}

impl Default for WatchdogKeys {
    fn default() -> Self {
        Self {
            timeout_s: 0.2,
            stop: true,
        }
    }
}

/// `[diagnosis]`: diagnoses ordered from the page or by a program.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DiagnosisKeys {
    /// Time after which a diagnosis is given up, s.
    #[schemars(range(min = 1.0, max = 86400.0))]
    pub time_limit_s: f64,
}

impl Default for DiagnosisKeys {
    /// A recorded move is diagnosed in seconds to a minute on an idle machine. Ten times a minute is left for
    /// a busy one, on which a diagnosis gets only what the tick leaves.
    fn default() -> Self {
        Self {
            time_limit_s: 600.0,
        }
    }
}

/// `[[joint]]`: one joint that is commanded. Without any, the one that the description moves.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct JointKeys {
    /// Name, as datagrams and requests call it.
    pub name: String,
    /// The joint of the description, counted from 1; the one that it moves where absent.
    pub number: Option<usize>,
    /// Lowest and highest position of the joint, deg: no command leaves them. Where absent -360 and 360, with a warning for
    /// a robot that is not simulated.
    #[serde(default, deserialize_with = "pair")]
    pub range_deg: Option<[f64; 2]>,
    /// Limit of the velocity, deg/s; the description's where absent.
    pub velocity_deg_s: Option<f64>,
    /// Limit of the acceleration, deg/s^2; the description's where absent.
    pub acceleration_deg_s2: Option<f64>,
    /// Limit of the jerk, deg/s^3; the description's where absent.
    pub jerk_deg_s3: Option<f64>,
    /// Distance of the motor side from its command that is a fault, deg, beyond what lag explains; where absent the
    /// most that a joint can have which follows within 0.06 s.
    #[schemars(range(min = 0.001, max = 360.0))]
    pub following_error_deg: Option<f64>,
    /// Believed natural frequency, Hz, until a better one is learned; the description's where absent.
    pub frequency_hz: Option<f64>,
    /// Believed damping ratio; the description's where absent.
    pub damping_ratio: Option<f64>,
    /// Shaper.
    #[serde(default = "zvd")]
    #[schemars(extend("enum" = shapers::names()))]
    pub shaper: String,
    /// Estimator.
    #[serde(default = "likelihood")]
    #[schemars(extend("enum" = estimators()))]
    pub estimator: String,
    /// Whether plans are shaped.
    #[serde(default = "yes")]
    pub shaping: bool,
    /// Whether the train follows the estimate.
    #[serde(default = "yes")]
    pub adaptation: bool,
    /// Samples a second of the sensor of tip, link or deformation, Hz; sizes the estimator's window.
    /// The description's tracker where absent.
    #[schemars(range(min = 1.0, max = 100000.0))]
    pub sensor_rate_hz: Option<f64>,
    /// Step of the encoder's reading, deg; the description's where absent.
    pub encoder_resolution_deg: Option<f64>,
    /// Full scale of the sensor of the deformation, deg: a reading there is refused as saturated.
    pub deformation_range_deg: Option<f64>,
}

impl JointKeys {
    /// A joint of that name, everything else as the description says.
    pub fn named(name: &str) -> Self {
        Self {
            name: name.into(),
            number: None,
            range_deg: None,
            velocity_deg_s: None,
            acceleration_deg_s2: None,
            jerk_deg_s3: None,
            following_error_deg: None,
            frequency_hz: None,
            damping_ratio: None,
            shaper: zvd(),
            estimator: likelihood(),
            shaping: true,
            adaptation: true,
            sensor_rate_hz: None,
            encoder_resolution_deg: None,
            deformation_range_deg: None,
        }
    }
}

/// Names of the robots.
pub fn robots() -> Vec<&'static str> {
    RobotKind::ALL.iter().map(|kind| kind.name()).collect()
}

/// Names of the estimators.
pub fn estimators() -> Vec<&'static str> {
    ESTIMATORS.iter().map(|entry| entry.name).collect()
}

fn zvd() -> String {
    "zvd".into()
}

fn likelihood() -> String {
    "likelihood".into()
}

fn yes() -> bool {
    true
}

fn pair<'de, D: Deserializer<'de>>(from: D) -> Result<Option<[f64; 2]>, D::Error> {
    exactly(from).map(Some)
}

//! `quell.toml`, checked; the command line overrides it.

mod check;
mod joint;
mod keys;
mod listed;
mod nats;
mod recording;
mod udp;
mod zenoh;

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::time::Duration;

use thiserror::Error;

use check::Check;
pub use joint::JointConfig;
use keys::{JointKeys, Keys};
pub use listed::listed;
pub use nats::NatsConfig;
pub use recording::RecordingConfig;
pub use zenoh::ZenohConfig;

use super::signature::Key;
use crate::plant::{Robot, RobotError};
use crate::recording::SyntaxError;

/// Range of the tick's rate, Hz.
const RATES: [f64; 2] = [250.0, 4000.0];
/// The longest name of a joint, bytes: a datagram holds it, and it names metrics.
const LONGEST_NAME: usize = 64;

/// Most joints: those of a redundant arm.
pub const MOST_JOINTS: usize = 7;

/// Why a configuration is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("{}: {reason}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The system's error.
        reason: String,
    },
    /// The file is not TOML, or a key is unknown or of another type.
    #[error("{}{error}", file.display())]
    Syntax {
        /// The file.
        file: PathBuf,
        /// Line and cause.
        error: SyntaxError,
    },
    /// A value that is out of its range.
    #[error("{origin}: {key} = {value}: it must be {expected}")]
    Value {
        /// The file with the key's line, or that it is a default or an option.
        origin: String,
        /// The key, as `joint[1].velocity_deg_s`, tables counted from 1.
        key: String,
        /// The value as given.
        value: String,
        /// The rule that it breaks.
        expected: String,
    },
    /// The robot's description is refused.
    #[error(transparent)]
    Robot(#[from] RobotError),
}

/// Which robot is commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RobotKind {
    /// The simulated arm, stepped by the tick.
    Embedded,
    /// One that speaks JSON over UDP.
    Udp,
    /// One that speaks ROS 2 over Zenoh; it needs the feature `zenoh`.
    Zenoh,
}

impl RobotKind {
    /// All of them, as the command line names them.
    pub const ALL: &[Self] = &[Self::Embedded, Self::Udp, Self::Zenoh];

    /// Name on the command line, in the configuration and in the state.
    pub fn name(self) -> &'static str {
        match self {
            Self::Embedded => "embedded",
            Self::Udp => "udp",
            Self::Zenoh => "zenoh",
        }
    }
}

/// Settings of the command line, which replace those of the file.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// Instead of `service.robot`.
    pub robot: Option<RobotKind>,
    /// Instead of `service.data`.
    pub data: Option<PathBuf>,
    /// Instead of `tick.rate_hz`.
    pub rate: Option<f64>,
    /// Instead of `http.address`.
    pub http: Option<SocketAddr>,
    /// Instead of `udp.address`.
    pub udp: Option<SocketAddr>,
}

/// A checked configuration.
#[derive(Clone)]
pub struct Config {
    /// Which robot.
    pub robot: RobotKind,
    /// Its description.
    pub description: Robot,
    /// Whether the description is that of the commanded robot.
    pub describes: bool,
    /// Folder of state and recordings.
    pub data: PathBuf,
    /// Control period, s.
    pub period: f64,
    /// Whether a real-time priority and locked memory are asked for.
    pub real_time: bool,
    /// Page and interface.
    pub http: HttpConfig,
    /// Where the UDP link listens.
    pub udp: SocketAddr,
    /// The robot's address; `None` takes that of its first datagram.
    pub udp_robot: Option<SocketAddr>,
    /// Signs datagrams both ways.
    pub udp_key: Option<Key>,
    /// How ROS 2 is reached, and its topics.
    pub zenoh: ZenohConfig,
    /// Where estimates and trains are published, if anywhere; it needs the feature `nats`.
    pub nats: Option<NatsConfig>,
    /// Address of the live view of Foxglove, if there is one; it needs the feature `foxglove`.
    pub foxglove: Option<SocketAddr>,
    /// Silence after which the adaptation pauses.
    pub watchdog: Duration,
    /// Whether a joint without measurements is stopped.
    pub watchdog_stops: bool,
    /// Recording of moves on disk.
    pub recording: RecordingConfig,
    /// Time after which a diagnosis is given up.
    pub diagnosis_limit: Duration,
    /// The joints, at least one.
    pub joints: Vec<JointConfig>,
}

/// Page and interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HttpConfig {
    /// Where it listens; port 0 takes a free one.
    pub address: SocketAddr,
    /// Token that every request must carry.
    pub token: Option<String>,
    /// Most connections at once.
    pub max_connections: usize,
    /// Longest body of a request, bytes.
    pub max_body: usize,
}

impl Config {
    /// The configuration from a file, or the defaults, overridden by the command line.
    ///
    /// # Errors
    /// [`ConfigError`] with file, line or key, and value.
    pub fn load(file: Option<&Path>, overrides: &Overrides) -> Result<Self, ConfigError> {
        let Some(file) = file else {
            let check = Check::of("defaults");
            return checked(Keys::default(), check, Path::new(""), overrides);
        };
        let text = std::fs::read_to_string(file).map_err(|error| ConfigError::Unreadable {
            file: file.to_path_buf(),
            reason: error.to_string(),
        })?;
        let keys = toml::from_str(&text).map_err(|error| ConfigError::Syntax {
            file: file.to_path_buf(),
            error: SyntaxError::of(&text, &error),
        })?;
        let folder = file.parent().unwrap_or(Path::new(""));
        let origin = file.display().to_string();
        let check = Check {
            origin: &origin,
            text: &text,
        };
        checked(keys, check, folder, overrides)
    }
}

fn checked(
    keys: Keys,
    check: Check,
    folder: &Path,
    overrides: &Overrides,
) -> Result<Config, ConfigError> {
    let robot = match overrides.robot {
        Some(robot) => robot,
        None => robot_kind(&keys.service.robot, &check)?,
    };
    let description = match &keys.service.description {
        Some(file) => Robot::from_file(&folder.join(file))?,
        None => Robot::rx170(),
    };
    // The description of the embedded arm does not give the geometry of another robot.
    let describes = robot == RobotKind::Embedded || keys.service.description.is_some();
    let (at, rate) = check.over(overrides.rate, keys.tick.rate_hz);
    let rate = at.within("tick.rate_hz", rate, RATES)?;
    let http = http(&keys, overrides, &check)?;
    let (at, udp) = check.over(overrides.udp, keys.udp.address);
    let udp_key = udp::key(&keys.udp, (at, udp), robot == RobotKind::Udp, &check)?;
    let data = overrides.data.clone().unwrap_or(keys.service.data);
    let recording = keys.recording.checked(&data, &check)?;
    let limit = check.within(
        "diagnosis.time_limit_s",
        keys.diagnosis.time_limit_s,
        [1.0, 86_400.0],
    )?;
    let joints = joints(&keys.joint, &description, robot, describes, &check)?;
    let names = joints.iter().map(|joint| joint.name.as_str());
    keys.zenoh.check(names, &check)?;
    keys.nats.iter().try_for_each(|nats| nats.check(&check))?;
    if let Some(address) = keys.foxglove.address.filter(|a| !a.ip().is_loopback()) {
        return Err(check.refuse(
            "foxglove.address",
            address,
            "loopback: whoever connects is not asked for a token",
        ));
    }
    let timeout = check.within("watchdog.timeout_s", keys.watchdog.timeout_s, [0.005, 60.0])?;
    Ok(Config {
        robot,
        period: 1.0 / rate,
        real_time: keys.tick.real_time,
        http,
        udp,
        udp_robot: keys.udp.robot,
        udp_key,
        zenoh: keys.zenoh,
        nats: keys.nats,
        foxglove: keys.foxglove.address,
        watchdog: Duration::from_secs_f64(timeout),
        watchdog_stops: keys.watchdog.stop,
        recording,
        diagnosis_limit: Duration::from_secs_f64(limit),
        data,
        joints,
        description,
        describes,
    })
}

fn robot_kind(name: &str, check: &Check) -> Result<RobotKind, ConfigError> {
    let found = RobotKind::ALL.iter().find(|kind| kind.name() == name);
    found
        .copied()
        .ok_or_else(|| check.unknown("service.robot", name, keys::robots()))
}

fn http(keys: &Keys, overrides: &Overrides, check: &Check) -> Result<HttpConfig, ConfigError> {
    let (at, address) = check.over(overrides.http, keys.http.address);
    let token = keys.http.token.clone().filter(|token| !token.is_empty());
    if !address.ip().is_loopback() && token.is_none() {
        let expected = "loopback, or else a token (http.token) must be set";
        return Err(at.refuse("http.address", address, expected));
    }
    let (connections, body) = (keys.http.max_connections, keys.http.max_body_bytes);
    check.within("http.max_connections", connections as f64, [1.0, 1e4])?;
    check.within("http.max_body_bytes", body as f64, [256.0, 1e8])?;
    Ok(HttpConfig {
        address,
        token,
        max_connections: connections,
        max_body: body,
    })
}

fn joints(
    keys: &[JointKeys],
    description: &Robot,
    robot: RobotKind,
    describes: bool,
    check: &Check,
) -> Result<Vec<JointConfig>, ConfigError> {
    let alone = [JointKeys {
        frequency_hz: (robot == RobotKind::Embedded).then(|| wrong_belief(description)),
        ..JointKeys::named("joint_1")
    }];
    let keys = if keys.is_empty() { &alone[..] } else { keys };
    let most = match robot {
        // The simulation moves one joint; the others stand still.
        RobotKind::Embedded => 1,
        RobotKind::Udp | RobotKind::Zenoh => MOST_JOINTS,
    };
    if keys.len() > most {
        let expected = format!("at most {most} for this robot");
        return Err(check.refuse("[[joint]] tables", keys.len(), expected));
    }
    let mut joints: Vec<JointConfig> = Vec::new();
    for (index, joint) in keys.iter().enumerate() {
        let at = format!("joint[{}]", index + 1);
        let fits = (1..=LONGEST_NAME).contains(&joint.name.len());
        let plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        if !fits || !joint.name.chars().all(plain) {
            let expected = "1 to 64 letters, digits, or any of _-.";
            return Err(check.refuse(&format!("{at}.name"), &joint.name, expected));
        }
        if joints.iter().any(|other| other.name == joint.name) {
            return Err(check.refuse(&format!("{at}.name"), &joint.name, "unlike every other"));
        }
        let mut checked = joint::checked(joint, &at, description, check)?;
        checked.range_assumed = robot != RobotKind::Embedded && joint.range_deg.is_none();
        if !describes {
            checked.arc = None;
            let limits = [
                joint.velocity_deg_s,
                joint.acceleration_deg_s2,
                joint.jerk_deg_s3,
            ];
            checked.limits_assumed = limits.contains(&None);
        }
        joints.push(checked);
    }
    Ok(joints)
}

/// The believed frequency of the embedded arm, Hz, if none is given: a quarter too high, as in `quell move`, so
/// that there is something to learn.
fn wrong_belief(description: &Robot) -> f64 {
    let joint = description.joints.get(description.default_move.joint);
    let mode = joint.and_then(|joint| joint.modes.first());
    1.25 * mode.map_or(joint::BELIEF.0, |entry| entry.mode.hertz())
}

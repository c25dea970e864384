//! `[zenoh]`: the link to a robot that speaks ROS 2 over Zenoh.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{Check, ConfigError};

/// The highest domain of ROS 2 on every system.
const HIGHEST_DOMAIN: f64 = 232.0;
/// The longest name of a topic, bytes: that of DDS.
const LONGEST_TOPIC: usize = 255;

/// `[zenoh]`: how ROS 2 is reached, and its topics. All of it may be left out.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct ZenohConfig {
    /// Endpoints that are connected to, as `tcp/127.0.0.1:7447`: there the router of `rmw_zenohd` listens.
    pub connect: Vec<String>,
    /// Endpoints that peers may connect to; port 0 takes a free one.
    pub listen: Vec<String>,
    /// Whether peers are looked for by multicast.
    pub multicast: bool,
    /// Domain of ROS 2, 0 to 232.
    #[schemars(range(min = 0, max = 232))]
    pub domain: u32,
    /// In, `sensor_msgs/JointState`: motor-side positions by the joints' names.
    pub joint_states: String,
    /// In, `sensor_msgs/JointState`: link positions by the joints' names, where a second encoder has them.
    pub link_states: String,
    /// In, `sensor_msgs/Imu`: acceleration of the tip.
    pub imu: String,
    /// The joint that the IMU rides on; the last one where absent.
    pub imu_joint: Option<String>,
    /// In, `trajectory_msgs/JointTrajectory`: its last point is the target of a move.
    pub targets: String,
    /// Out at each tick, `std_msgs/Float64MultiArray`: positions in the order of the `[[joint]]` tables.
    pub commands: String,
}

impl Default for ZenohConfig {
    fn default() -> Self {
        Self {
            connect: vec!["tcp/127.0.0.1:7447".into()],
            listen: vec!["tcp/127.0.0.1:0".into()],
            multicast: false,
            domain: 0,
            joint_states: "/joint_states".into(),
            link_states: "/link_states".into(),
            imu: "/imu".into(),
            imu_joint: None,
            targets: "/joint_trajectory_controller/joint_trajectory".into(),
            commands: "/forward_position_controller/commands".into(),
        }
    }
}

impl ZenohConfig {
    /// Checks the values; `joints` are the names of those that are commanded.
    ///
    /// # Errors
    /// [`ConfigError`] where a value is out of its range, or a topic has no name that ROS 2 allows.
    pub(super) fn check<'a>(
        &self,
        mut joints: impl Iterator<Item = &'a str>,
        check: &Check,
    ) -> Result<(), ConfigError> {
        check.within("zenoh.domain", self.domain.into(), [0.0, HIGHEST_DOMAIN])?;
        let topics = [
            ("joint_states", &self.joint_states),
            ("link_states", &self.link_states),
            ("imu", &self.imu),
            ("targets", &self.targets),
            ("commands", &self.commands),
        ];
        for (key, topic) in topics {
            if !is_topic(topic) {
                let expected =
                    "a topic's full name, as /joint_states: letters, digits and _ between slashes";
                return Err(check.refuse(&format!("zenoh.{key}"), topic, expected));
            }
        }
        match &self.imu_joint {
            Some(name) if joints.all(|joint| joint != name) => {
                Err(check.refuse("zenoh.imu_joint", name, "the name of a joint"))
            }
            _ => Ok(()),
        }
    }
}

/// Source: ROS 2 design, "Topic and service name mapping", ROS 2 topic names, fully qualified.
fn is_topic(name: &str) -> bool {
    let token = |part: &str| {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let first = part.chars().next();
        first.is_some_and(|c| !c.is_ascii_digit()) && part.chars().all(plain)
    };
    let tokens = name.strip_prefix('/');
    name.len() <= LONGEST_TOPIC && tokens.is_some_and(|tokens| tokens.split('/').all(token))
}

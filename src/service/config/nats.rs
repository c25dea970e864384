//! `[nats]`: what the robot learns, told to a fleet.

use schemars::JsonSchema;
use serde::Deserialize;

use super::{Check, ConfigError};

/// The longest name of a robot, bytes: as that of a joint.
const LONGEST_NAME: usize = 64;

/// `[nats]`: where estimates and trains are published; nowhere where the table is left out.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NatsConfig {
    /// Address of the server, as `nats://host:4222`; it may hold a user and a password.
    pub server: String,
    /// Name of the robot, the second word of every subject.
    pub robot: String,
}

impl NatsConfig {
    /// # Errors
    /// [`ConfigError`] where a value cannot be what it should.
    pub(super) fn check(&self, check: &Check) -> Result<(), ConfigError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
        let fits = (1..=LONGEST_NAME).contains(&self.robot.len());
        if !fits || !self.robot.chars().all(plain) {
            let expected = "1 to 64 letters, digits, or any of _-";
            return Err(check.refuse("nats.robot", &self.robot, expected));
        }
        match self.server.is_empty() {
            true => Err(check.refuse("nats.server", "", "an address, as nats://host:4222")),
            false => Ok(()),
        }
    }
}

//! Whether moves may begin.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Whether moves may begin, for all joints alike: one that is at fault stops the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum EnableState {
    /// No move begins: nobody has enabled since the start, a reset, or since somebody disabled.
    #[default]
    Disabled,
    /// A move that is asked for begins.
    Enabled,
    /// A fault has stopped the robot. No move begins until somebody resets it, and then enables.
    Faulted,
}

/// The kind of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FaultKind {
    /// The motor side of a joint is not heard.
    Silent,
    /// Nothing of the robot is heard.
    LinkLost,
    /// A motor side does not follow its command.
    FollowingError,
    /// The sensor of a motor side says what cannot be, or sends no numbers for as long as it may be silent.
    Sensor,
    /// Ticks were missed for so long that the robot has stood meanwhile.
    TickOverrun,
    /// A command would have led its joint out of its range.
    Range,
}

/// Whether moves may begin, and why not.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct EnableView {
    /// The state.
    pub state: EnableState,
    /// Why it is what it is, in a sentence.
    pub reason: String,
    /// The kind of the fault, while there is one.
    pub fault: Option<FaultKind>,
    /// The joint at fault, where it is one.
    pub joint: Option<String>,
    /// Since when, seconds since 1970.
    pub since_unix_time_s: f64,
    /// Faults since the service started.
    pub faults: u64,
}

//! The requests of the outside.

use quell_shapers::{Mode, ModeError};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::EnableState;
use crate::tolerance::Tolerance;

/// The requests of the outside.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Move a joint to a target, from rest or in mid-move.
    Move {
        /// Name of the joint.
        joint: String,
        /// Where it shall end, rad.
        target: f64,
        /// Shaper for this move alone, `none` for unshaped; the joint's own where absent.
        shaper: Option<String>,
    },
    /// Move a joint from rest, as fast as a tolerance allows.
    MoveWithin {
        /// Name of the joint.
        joint: String,
        /// Where it shall end, rad.
        target: f64,
        /// What it may leave.
        tolerance: Tolerance,
    },
    /// Move several joints from rest, so that they begin and end together.
    MoveTogether {
        /// The joints and where they shall end.
        targets: Vec<Target>,
        /// Shaper for this move alone, `none` for unshaped; each joint's own where absent.
        shaper: Option<String>,
        /// What it may leave, in the place of a shaper, where it is to be as fast as that allows.
        tolerance: Option<Tolerance>,
    },
    /// Move a joint while it is held moving.
    Jog {
        /// Name of the joint.
        joint: String,
        /// Velocity, rad/s; 0 ends the hold.
        velocity: f64,
        /// Number of the hold, another one for each press of a button.
        hold: u64,
    },
    /// Move at a share of full speed, 0.01 to 1, or 0. What moves follows it; at 0 it stops.
    Feed {
        /// The share.
        share: f64,
    },
    /// Bring every joint to a jerk-limited stop.
    Stop,
    /// Let moves begin. Nothing moves by this alone.
    Enable,
    /// Stop every joint, and let no move begin.
    Disable,
    /// Take a fault back, once somebody has seen to it. Moves stay disabled.
    Reset,
    /// Change how commands are shaped; all of it or, on an error, nothing.
    Shaping(ShapingChange),
    /// Forget what moves have taught of a joint; the mode of the configuration is believed again.
    Forget {
        /// Name of the joint.
        joint: String,
    },
    /// Declare the payload from now on. The embedded arm takes it up, a point mass at the tip.
    Payload {
        /// Mass, kg, 0 or more.
        mass: f64,
    },
}

impl Request {
    /// Whether it begins a motion.
    pub fn moves(&self) -> bool {
        match self {
            Self::Move { .. } | Self::MoveWithin { .. } | Self::MoveTogether { .. } => true,
            Self::Jog { velocity, .. } => *velocity != 0.0,
            _ => false,
        }
    }

    /// Whether it begins nothing: it is heard also where the tick is stuck.
    pub fn is_heard_always(&self) -> bool {
        match self {
            Self::Stop | Self::Disable | Self::Feed { .. } => true,
            Self::Jog { velocity, .. } => *velocity == 0.0,
            _ => false,
        }
    }
}

/// Where a joint shall end.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    /// Name of the joint.
    pub joint: String,
    /// Where it shall end, rad.
    pub target: f64,
}

/// A change of how commands are shaped. What is absent stays as it is; trains change at rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ShapingChange {
    /// The joint; every joint where absent.
    pub joint: Option<String>,
    /// Whether plans are shaped.
    pub enabled: Option<bool>,
    /// Whether the train follows the estimate.
    pub adaptation: Option<bool>,
    /// Name of the shaper.
    pub kind: Option<String>,
    /// The mode to shape for, from now on and until the estimate says better.
    pub mode: Option<ModeValue>,
}

/// A mode as people write it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ModeValue {
    /// Undamped natural frequency, Hz.
    pub frequency_hz: f64,
    /// Damping ratio, from 0 to below 1.
    pub damping_ratio: f64,
}

impl From<Mode> for ModeValue {
    fn from(mode: Mode) -> Self {
        Self {
            frequency_hz: mode.hertz(),
            damping_ratio: mode.damping_ratio(),
        }
    }
}

impl TryFrom<ModeValue> for Mode {
    type Error = ModeError;

    fn try_from(value: ModeValue) -> Result<Self, ModeError> {
        Mode::from_hertz(value.frequency_hz, value.damping_ratio)
    }
}

/// The outcome of a request that was taken.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "accepted", rename_all = "snake_case")]
pub enum Accepted {
    /// The move has begun.
    Move {
        /// Number of the move, counted up for ever; its result appears under it.
        id: u64,
        /// How long the plan lasts without the train, s.
        duration_s: f64,
        /// Speed to which the plan was slowed so that the train keeps the limits; 1 is full speed.
        speed: f64,
    },
    /// A move of several joints has begun.
    Together {
        /// Their moves.
        moves: Vec<Begun>,
        /// Until all commands rest, with the trains, s.
        duration_s: f64,
    },
    /// The hold is renewed, or has ended as was asked.
    Jog {
        /// Unless it is renewed within this time the joint is stopped, s.
        held_s: f64,
    },
    /// Every joint that moves is being stopped.
    Stop {
        /// How long the longest stop lasts, s; 0 where nothing moves.
        duration_s: f64,
        /// The joints that are being stopped; none where nothing moves.
        joints: Vec<Stopping>,
    },
    /// Moves are enabled, disabled or faulted, as it says.
    EnableState {
        /// The state.
        state: EnableState,
    },
    /// The change is in force, or will be with the next move from rest.
    Changed,
}

/// The move of one joint of several.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Begun {
    /// Name of the joint.
    pub joint: String,
    /// Number of the move.
    pub id: u64,
}

/// A joint that is being stopped.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Stopping {
    /// Its name.
    pub joint: String,
    /// Time until the command rests, with the train, s; absent where the stop is still being planned.
    pub duration_s: Option<f64>,
}

//! Reasons for refusing a request, in one sentence for the client.

use thiserror::Error;

use crate::service::shapers::POSITIVE;

/// Why a request is refused. A refusal changes nothing.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ServiceError {
    /// No joint has that name.
    #[error("there is no joint \"{joint}\"; there are: {known}")]
    UnknownJoint {
        /// The name asked for.
        joint: String,
        /// The names that there are.
        known: String,
    },
    /// No shaper has that name.
    #[error("there is no shaper \"{shaper}\"; there are: {known}")]
    UnknownShaper {
        /// The name asked for.
        shaper: String,
        /// The names that there are.
        known: String,
    },
    /// That shaper has negative impulses.
    #[error("the shaper is \"{shaper}\", it must be {POSITIVE}")]
    NegativeShaper {
        /// The name asked for.
        shaper: String,
    },
    /// A plan that would leave the joint's range.
    #[error("{joint} cannot do that: it would come to {:.2} deg, beyond its range", .position.to_degrees())]
    LeavesRange {
        /// The joint.
        joint: String,
        /// Where it would come to, rad.
        position: f64,
    },
    /// A jog toward an end of the range at which the joint is, or beyond.
    #[error(
        "{joint} has no room in that direction: it is at {:.2} deg, and its range ends at {:.2} deg",
        .position.to_degrees(), .end.to_degrees()
    )]
    NoRoom {
        /// The joint.
        joint: String,
        /// Where it is, rad.
        position: f64,
        /// The end of its range, rad.
        end: f64,
    },
    /// A value is out of its range, or not finite.
    #[error("{what} is {value}, it must be {rule}")]
    Value {
        /// Which value, with its unit.
        what: &'static str,
        /// The given value.
        value: f64,
        /// The rule that it breaks.
        rule: &'static str,
    },
    /// The request changes nothing at all.
    #[error("the request names nothing to change")]
    Nothing,
    /// A move of several joints that names none.
    #[error("the move names no joint")]
    NoJoints,
    /// The move cannot be planned, or not within the limits.
    #[error("the move cannot be planned: {reason}")]
    Plan {
        /// The planner's error.
        reason: String,
    },
    /// A mode for which no train can be designed at this rate.
    #[error("no train for this mode: {reason}")]
    Train {
        /// The shaper's error.
        reason: String,
    },
    /// Another shaper can only be taken at rest.
    #[error("{joint} is moving: a move with another shaper has to wait until it rests")]
    ShaperInMotion {
        /// The joint.
        joint: String,
    },
    /// A move of several joints begins at rest only.
    #[error("{joint} is moving: a move of several joints has to wait until it rests")]
    InMotion {
        /// The joint.
        joint: String,
    },
    /// A move of several joints that names one of them twice.
    #[error("{joint} has two targets in one move")]
    Twice {
        /// The joint.
        joint: String,
    },
    /// A hold that has ended moves nothing.
    #[error("this hold of {joint} is over: let go and press again")]
    HoldOver {
        /// The joint.
        joint: String,
    },
    /// Another client holds the joint moving.
    #[error("{joint} is held moving by somebody else")]
    Held {
        /// The joint.
        joint: String,
    },
    /// With a feed of 0 nothing moves.
    #[error("the feed is 0 %: no move begins")]
    NoFeed,
    /// A correction took so long that the new plan could not be accepted.
    #[error("{joint}: {reason}; the running move goes on")]
    NotTaken {
        /// The joint.
        joint: String,
        /// Why.
        reason: String,
    },
    /// Moves were not enabled, or not since a fault.
    #[error("moves are not enabled: {reason}; {way}")]
    NotEnabled {
        /// Why, as the state says it.
        reason: String,
        /// What has to be asked for first.
        way: &'static str,
    },
    /// A fault has to be reset before moves are enabled.
    #[error("there is a fault: {reason}; see to it, then reset it, then enable")]
    Faulted {
        /// Why, as the state says it.
        reason: String,
    },
    /// A joint is not at its commanded position, or its sensor is at fault.
    #[error("{joint} cannot be enabled: {reason}")]
    NotReady {
        /// The joint.
        joint: String,
        /// Why.
        reason: String,
    },
    /// The robot has not reported the joint's position yet.
    #[error("the robot has not yet said where {joint} stands")]
    NoMeasurement {
        /// The joint.
        joint: String,
    },
    /// The robot is silent, and a joint is not moved without measurements.
    #[error("{joint} is not heard: it takes no move until it says again where it stands")]
    NotHeard {
        /// The joint.
        joint: String,
    },
    /// Only the embedded arm can do that.
    #[error("only the embedded arm has {what}")]
    OnlyEmbedded {
        /// The operation that was asked for.
        what: &'static str,
    },
    /// Every move must be recorded, but recording fails.
    #[error(
        "no move without a recording (recording.required), and nothing can be recorded: {reason}"
    )]
    NotRecorded {
        /// The disk's error.
        reason: String,
    },
    /// A stop came before the move could begin.
    #[error("a stop came before the move could begin")]
    Stopped,
    /// The service is about to end.
    #[error("the service is stopping")]
    Stopping,
    /// Too many requests wait already.
    #[error("too many requests wait already; try again")]
    Busy,
    /// The computer did not do in time what the request needs.
    #[error("this computer is too busy: {what}; try again")]
    Overloaded {
        /// What was not done.
        what: &'static str,
    },
    /// The engine has ended.
    #[error("the engine has ended")]
    Gone,
}

/// The cause of an error; it decides the HTTP status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The request itself is wrong (HTTP 400, 422).
    Input,
    /// The request is valid, but not possible now (HTTP 409).
    Conflict,
    /// The disk does not accept data that must be kept (HTTP 507).
    Storage,
    /// No answer is possible at present (HTTP 503).
    Unavailable,
}

impl ServiceError {
    /// No joint has that name; the error lists the known ones.
    pub fn unknown_joint<'a>(joint: &str, known: impl Iterator<Item = &'a str>) -> Self {
        Self::UnknownJoint {
            joint: joint.to_owned(),
            known: known.collect::<Vec<_>>().join(", "),
        }
    }

    /// The cause.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::UnknownJoint { .. }
            | Self::UnknownShaper { .. }
            | Self::NegativeShaper { .. }
            | Self::Value { .. }
            | Self::Nothing
            | Self::NoJoints
            | Self::Twice { .. }
            | Self::Plan { .. }
            | Self::Train { .. }
            | Self::OnlyEmbedded { .. } => ErrorKind::Input,
            Self::ShaperInMotion { .. }
            | Self::InMotion { .. }
            | Self::HoldOver { .. }
            | Self::LeavesRange { .. }
            | Self::NoRoom { .. }
            | Self::Held { .. }
            | Self::NoFeed
            | Self::NotTaken { .. }
            | Self::NotEnabled { .. }
            | Self::Faulted { .. }
            | Self::NotReady { .. }
            | Self::NoMeasurement { .. }
            | Self::NotHeard { .. }
            | Self::Stopped => ErrorKind::Conflict,
            Self::NotRecorded { .. } => ErrorKind::Storage,
            Self::Stopping | Self::Busy | Self::Overloaded { .. } | Self::Gone => {
                ErrorKind::Unavailable
            }
        }
    }
}

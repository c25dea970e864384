//! Reasons for refusing values.

use quell_recording::plain;
use std::path::PathBuf;

/// A refusal of this crate; it contains the bad value and its origin.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SignalError {
    /// A joint index beyond the chain.
    #[error("joint {joint} does not exist: the chain has {joints} joints, counted from 1")]
    NoSuchJoint {
        /// Joint as asked for, counted from 1.
        joint: usize,
        /// Joints in the chain.
        joints: usize,
    },
    /// A joint that slides where one that turns is needed.
    #[error("joint {joint} slides: its tip draws no arc")]
    NotRevolute {
        /// Joint, counted from 1.
        joint: usize,
    },
    /// The tip lies on the joint's axis, so turning the joint does not move it.
    #[error("the tip lies {radius} m from the axis of joint {joint}: turning it shows nothing")]
    TipOnAxis {
        /// Joint, counted from 1.
        joint: usize,
        /// Distance from the axis, m.
        radius: f64,
    },
    /// A length that must be positive and finite is not.
    #[error("{name} = {value} m is not a finite length above 0")]
    Length {
        /// Which length.
        name: &'static str,
        /// The value, m.
        value: f64,
    },
    /// A robot description (URDF) that cannot be read as a chain.
    #[error("{}: {reason}", file.display())]
    Urdf {
        /// The file.
        file: PathBuf,
        /// The fault in it.
        reason: String,
    },
    /// Fewer samples than the method needs.
    #[error("{what}: {found} samples, at least {needed} are needed")]
    TooFew {
        /// Which series or set.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// Two series that should correspond differ in length.
    #[error("{what}: lengths {left} and {right} differ")]
    Lengths {
        /// Which pair.
        what: &'static str,
        /// Length of the first.
        left: usize,
        /// Length of the second.
        right: usize,
    },
    /// A value that is not finite.
    #[error("{what}: sample {index} is {}, not a finite number", plain(*.value))]
    NotFinite {
        /// Which series.
        what: &'static str,
        /// Index of the sample, counted from 0.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A clock that does not advance.
    #[error("{what}: time {} s at sample {index} does not advance", plain(*.time))]
    TimeOrder {
        /// Which series.
        what: &'static str,
        /// Index of the sample, counted from 0.
        index: usize,
        /// Its stamp, s.
        time: f64,
    },
    /// Stamps so far apart that nothing can be simulated over them.
    #[error(
        "{what}: {} s follows {} s, and the simulation would take {steps:.1e} steps, {most:.0e} at most: is a stamp of another clock?",
        plain(*.after), plain(*.before)
    )]
    TooLong {
        /// Which series.
        what: &'static str,
        /// The stamp before the longest pause, s.
        before: f64,
        /// The stamp after it, s.
        after: f64,
        /// Steps over all stamps.
        steps: f64,
        /// Most steps.
        most: f64,
    },
    /// Points that do not determine a transform.
    #[error(
        "the points do not determine the frame: rotation about ({:.3}, {:.3}, {:.3}) is free",
        direction[0], direction[1], direction[2]
    )]
    Degenerate {
        /// Unit vector, in the source frame, about which the rotation is undetermined.
        direction: [f64; 3],
    },
    /// A recording without the channels that the method needs.
    #[error("recording \"{recording}\" has no channel {channel}")]
    MissingChannel {
        /// Name of the recording.
        recording: String,
        /// Role of the channel.
        channel: &'static str,
    },
    /// A recorded move is too small for the requested quantity.
    #[error("{what}: {found} where at least {needed} is needed")]
    NotExcited {
        /// The quantity to be determined, with its unit.
        what: &'static str,
        /// The value that the recording offers.
        found: f64,
        /// The value that is needed.
        needed: f64,
    },
}

//! The aim of a retune, and its answer.

use crate::{GridTrain, MotionLimits, PeakRatios, ShaperError, UncertainMode};

/// The aim of a retune.
#[derive(Clone, Copy, Debug)]
pub struct Retune<'a> {
    /// The train to go over to.
    pub train: &'a GridTrain,
    /// The modes whose vibration is cancelled, 1 to 3, and how well they are known; the first sets the pace.
    pub modes: &'a [UncertainMode],
    /// Limits that nothing sent exceeds.
    pub limits: MotionLimits,
    /// Gain below which nothing is changed: the vibration taken away, as a fraction (RMS over the rest of the move
    /// and its decay) of that of the planned input.
    pub dead_band: f64,
    /// Amplitude below which a vibration is not measurable, in units of the position.
    pub resolution: f64,
}

/// The outcome of a retune.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RetuneOutcome {
    /// Nothing had moved: the train is in force, or will be at rest.
    Installed,
    /// The command goes on as described.
    Corrected(Correction),
    /// Nothing was changed.
    Refused(Refusal),
}

/// How a command goes on after a retune.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Length of the cross-fade, s; 0 where the old train is kept to the end of the move and the
    /// new one takes over at rest.
    pub cross_fade: f64,
    /// Length of the correction, s; 0 where there is none.
    pub duration: f64,
    /// Number of its smooth steps; 0 where there is none.
    pub steps: usize,
    /// From now to the end of the whole command, s.
    pub until_rest: f64,
    /// Whether the slope over frequency and damping is cancelled too.
    pub robust: bool,
    /// Peaks of the command from now on, over the limits.
    pub peaks: PeakRatios,
}

/// Why a retune was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The train or a limit is not usable here.
    #[error("{0}")]
    Invalid(ShaperError),
    /// The number of modes is not 1 to 3.
    #[error("{0} modes to correct; 1 to 3 are possible")]
    Modes(usize),
    /// More ticks ahead than the filter looks.
    #[error("{needed} ticks ahead; the filter looks {horizon} ahead")]
    Horizon {
        /// Ticks until the command is at rest.
        needed: usize,
        /// Ticks that the filter can look ahead.
        horizon: usize,
    },
    /// The start of the move has been overwritten.
    #[error("the start of the move is older than the filter remembers")]
    HistoryLost,
    /// No correction that begins now keeps the limits.
    #[error("no correction that begins now keeps the limits")]
    Limits,
    /// The best correction gains too little: the vibration taken away, as a fraction of the unshaped.
    #[error("the best correction takes away {0} of the unshaped vibration: too little")]
    NotWorth(f64),
    /// Too many steps of earlier corrections are under way.
    #[error("too many steps of earlier corrections are under way")]
    Busy,
}

//! The train of a move, and the reason for it.

use quell_shapers::{GridTrain, Mode, UncertainMode};

use super::path::NODES;

/// Why the train is not adapted in motion as that of one constant mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// The joint has several modes.
    SeveralModes,
    /// The mode changes along the way by more than the dead band.
    Pose,
    /// Adaptation has left more than the train without it would have.
    Worse,
    /// The modes leave more of the vibration unexplained than the dead band.
    Unexplained,
}

impl Hold {
    /// A short stable name, as in documents.
    pub fn name(self) -> &'static str {
        match self {
            Self::SeveralModes => "several_modes",
            Self::Pose => "pose",
            Self::Worse => "worse",
            Self::Unexplained => "unexplained",
        }
    }

    /// The target of the train, in place of one constant mode.
    pub fn reason(self) -> &'static str {
        match self {
            Self::SeveralModes => "several modes",
            Self::Pose => "a mode that follows the pose",
            Self::Worse => "the belief, because what was learned left more",
            Self::Unexplained => "what the modes explain, and for the belief in what they do not",
        }
    }
}

/// A mode on the way of the next move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeOnWay {
    /// The mode at evenly spaced nodes from start to end.
    pub modes: [Mode; NODES],
    /// Uncertainty of the one in the middle.
    pub known: UncertainMode,
    /// Its share of the unshaped vibration of the move.
    pub contribution: f64,
    /// Whether it is shaped for: not if its share is below the dead band.
    pub shaped: bool,
}

impl ModeOnWay {
    /// The mode that contributes most.
    pub fn strongest(modes: &[Self]) -> Option<&Self> {
        modes
            .iter()
            .max_by(|a, b| a.contribution.total_cmp(&b.contribution))
    }

    /// One mode whose two standard deviations cover the mode at all places of the way.
    pub fn anywhere(&self) -> UncertainMode {
        let frequencies = self.modes.map(|mode| mode.natural_frequency());
        let least = frequencies.into_iter().fold(f64::INFINITY, f64::min);
        let most = frequencies.into_iter().fold(0.0, f64::max);
        let middle = Mode::new(0.5 * (least + most), self.known.mode.damping_ratio());
        UncertainMode {
            mode: middle.unwrap_or(self.known.mode),
            natural_frequency_std: self.known.natural_frequency_std + 0.25 * (most - least),
            ..self.known
        }
    }
}

/// The prescription for a move.
#[derive(Clone, Debug, PartialEq)]
pub struct Prescription {
    /// A train to be set; `None` keeps the one in force.
    pub train: Option<GridTrain>,
    /// The mode that contributes most.
    pub known: Option<UncertainMode>,
    /// All modes.
    pub modes: Vec<ModeOnWay>,
    /// Expected residual as a share of the unshaped vibration; `None` without known modes.
    pub expected: Option<f64>,
    /// Why the train is not adapted in motion.
    pub hold: Option<Hold>,
}

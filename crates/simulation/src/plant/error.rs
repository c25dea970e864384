//! Why robot descriptions and simulation options are refused.

use std::path::PathBuf;

use quell_recording::SyntaxError;
use quell_shapers::ModeError;
use quell_signal::SignalError;

/// Why a robot description is refused; carries file, key and value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RobotError {
    /// The file cannot be read.
    #[error("{}: {reason}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The system's error.
        reason: String,
    },
    /// The file is not TOML, or a key is missing, unknown or of another type.
    #[error("{}{error}", file.display())]
    Syntax {
        /// The file.
        file: PathBuf,
        /// Line and cause.
        error: SyntaxError,
    },
    /// A value that is out of its range.
    #[error("{}{}: {key} = {value}: {expected}", file.display(), at(*.line))]
    Value {
        /// The file.
        file: PathBuf,
        /// Line of the key, counted from 1; none where the file does not have it.
        line: Option<usize>,
        /// The key, as `joint[1].mode[1].damping_ratio`, tables counted from 1.
        key: String,
        /// The value as given.
        value: String,
        /// The rule that it breaks.
        expected: &'static str,
    },
    /// The kinematics cannot be used.
    #[error("{}: {reason}", file.display())]
    Kinematics {
        /// The file.
        file: PathBuf,
        /// Why.
        reason: SignalError,
    },
}

/// A line behind the name of a file.
fn at(line: Option<usize>) -> String {
    line.map_or_else(String::new, |line| format!(":{line}"))
}

/// Why a simulation cannot be set up or changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// The joint or the pose is not suitable.
    #[error(transparent)]
    Kinematics(#[from] SignalError),
    /// Pose and payload lead to an invalid mode.
    #[error("mode at this pose and payload: {0}")]
    Mode(#[from] ModeError),
    /// An option out of its range.
    #[error("{name} = {value}: {expected}")]
    Option {
        /// Which option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The rule that it breaks.
        expected: &'static str,
    },
}

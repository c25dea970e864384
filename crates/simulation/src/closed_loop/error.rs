//! Why a closed loop could not be run.

use quell_shapers::ShaperError;
use quell_trajectories::PlanError;

use crate::plant::SimulationError;
use quell_control::controller::LoadError;
use quell_control::tolerance::ToleranceError;
use quell_signal::SignalError;

/// Why a closed loop could not be run.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClosedLoopError {
    /// The move cannot be planned.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The belief cannot be shaped for.
    #[error(transparent)]
    Shaper(#[from] ShaperError),
    /// The arm cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The tracker cannot be registered.
    #[error("commissioning: {0}")]
    Registration(#[from] SignalError),
    /// The controller refused the plan.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// No move is within the tolerance.
    #[error(transparent)]
    Tolerance(#[from] ToleranceError),
    /// The shaped move exceeds a limit at any speed that was tried.
    #[error("the shaped move reaches {ratio:.2} times a limit, even at {percent:.0} % speed")]
    Limits {
        /// Largest ratio of a peak to its limit.
        ratio: f64,
        /// Speed at which it was tried last, percent.
        percent: f64,
    },
}

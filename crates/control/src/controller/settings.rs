//! Settings of an axis, fixed before its first tick.

use quell_shapers::{Mode, MotionLimits, Shaper};
use quell_trajectories::Limits;

use crate::adaptation::AdaptationSettings;
use crate::estimators::{EstimatorEntry, Settings};
use quell_signal::{DeformationSensor, RestRule};

/// When a new train takes effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RetunePolicy {
    /// With the next move: the running command is not changed.
    AtRest,
    /// At once: by a cross-fade, and a correction that cancels what the old train would have left.
    InMotion,
}

/// Settings of an axis, fixed before its first tick.
pub struct AxisSettings {
    /// Control period, s.
    pub sample_time: f64,
    /// Limits of the joint; corrections are checked against them.
    pub limits: Limits,
    /// The rule that designs trains; `None` sends the plan as it is.
    pub shaper: Option<&'static dyn Shaper>,
    /// The mode that is shaped for until a better one is known.
    pub belief: Mode,
    /// Whether the train follows the estimate.
    pub adaptive: bool,
    /// When a new train takes effect.
    pub retune: RetunePolicy,
    /// Method of estimation.
    pub estimator: &'static EstimatorEntry,
    /// The settings of the estimator.
    pub estimation: Settings,
    /// The settings of the adaptation.
    pub adaptation: AdaptationSettings,
    /// The rule for rest of the motor side.
    pub rest: RestRule,
    /// Computes the deformation from measurements.
    pub sensor: DeformationSensor,
    /// Longest train, s; sizes the delay line.
    pub longest_train: f64,
    /// Longest move, s; sizes the memory of the sent command.
    pub longest_move: f64,
}

/// The planner's limits as the shapers' crate names them; the two crates do not know each other.
pub fn motion_limits(limits: Limits) -> MotionLimits {
    let Limits {
        velocity,
        acceleration,
        jerk,
    } = limits;
    MotionLimits {
        velocity,
        acceleration,
        jerk,
    }
}

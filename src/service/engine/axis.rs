//! Construction of a joint's controller from the configuration.

use quell_shapers::{GridTrain, Mode, Shaper, ShaperError, UncertainMode};

use crate::adaptation::AdaptationSettings;
use crate::controller::{AxisSettings, Controller, RetunePolicy};
use crate::estimators::Settings;
use crate::service::config::JointConfig;
use crate::service::link::INBOX;
use crate::service::remembered::{LONGEST_MOVE, LONGEST_TRAIN};
use crate::signal::{DeformationSensor, RestRule};

/// A controller of a joint at rest at `position` (rad), shaping for `mode`.
pub fn controller(
    joint: &JointConfig,
    shaper: Option<&'static dyn Shaper>,
    mode: Mode,
    sensor: DeformationSensor,
    position: f64,
    period: f64,
) -> Result<Controller, ShaperError> {
    let adaptation = AdaptationSettings::around(joint.belief);
    let [low, high] = adaptation.natural_frequency;
    let settings = AxisSettings {
        sample_time: period,
        limits: joint.limits,
        shaper,
        belief: mode,
        adaptive: joint.adaptation,
        retune: RetunePolicy::InMotion,
        estimator: joint.estimator,
        estimation: Settings {
            // Every frequency that may be accepted must be in the estimator's range.
            frequency_range: (low, high),
            ..Settings::around(mode, 1.0 / joint.sensor_rate)
        },
        adaptation,
        rest: RestRule::new(0.0, joint.encoder_resolution),
        sensor,
        longest_train: longest_train(joint),
        longest_move: LONGEST_MOVE,
    };
    let mut controller = Controller::new(settings, position)?;
    // Those of one tick, which hands them on.
    controller.keep_samples(INBOX);
    controller.keep_spare();
    Ok(controller)
}

/// The longest train of a joint, s.
pub fn longest_train(joint: &JointConfig) -> f64 {
    LONGEST_TRAIN * joint.belief.damped_period()
}

/// The train of a shaper for a mode with its uncertainty; without a shaper the plan is sent unshaped.
pub fn train(
    shaper: Option<&'static dyn Shaper>,
    known: &UncertainMode,
    period: f64,
) -> Result<GridTrain, ShaperError> {
    match shaper {
        Some(shaper) => shaper.on_grid_for(known, period),
        None => GridTrain::identity(period),
    }
}

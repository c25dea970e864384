//! An axis of the embedded arm as tests and benches build it.

use quell::adaptation::AdaptationSettings;
use quell::controller::{AxisSettings, RetunePolicy};
use quell::estimators::{Settings, estimator};
use quell::plant::Robot;
use quell::signal::RestRule;
use quell_shapers::{Mode, shaper_by_name};

/// Adaptive in motion, with ZVD and the likelihood estimator, at the joint's own limits; ticks and samples of
/// the sensor are so many seconds apart.
pub fn axis_settings(belief: Mode, tick: f64, sample: f64) -> AxisSettings {
    let robot = Robot::rx170();
    AxisSettings {
        sample_time: tick,
        limits: robot.joints[0].limits,
        shaper: shaper_by_name("zvd"),
        belief,
        adaptive: true,
        retune: RetunePolicy::InMotion,
        estimator: estimator("likelihood").expect("an estimator"),
        estimation: Settings::around(belief, sample),
        adaptation: AdaptationSettings::around(belief),
        rest: RestRule::new(0.0, robot.encoder.resolution),
        sensor: robot
            .deformation_sensor(&robot.home(), 0)
            .expect("a sensor"),
        longest_train: 0.5,
        longest_move: 20.0,
    }
}

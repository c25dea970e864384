//! Sets of effects that no such motion tells apart, and why.

use quell::effects::Effect;

/// Effects that stand for each other, and the reason.
const SETS: &[(&[&str], &str)] = &[
    (
        &["sensor_gain", "misalignment", "gravity_load"],
        "each is a function of the pose alone; only another payload or another mounting of the sensor \
         tells them apart",
    ),
    (
        &["second_mode", "base_mode"],
        "both are a resonance that the reaction of the arm drives; only its frequency, or a sensor on the \
         base, tells them apart",
    ),
    (
        &["drive_lag", "sensor_lag"],
        "in a chain that is linear the order of its parts does not show",
    ),
    (
        &["drive_delay", "sensor_delay"],
        "in a chain that is linear the order of its parts does not show",
    ),
    (
        &["viscous_friction", "viscous_drag"],
        "in a rigid axis drive and link are one body",
    ),
    (
        &["deformation_gain", "sensor_gain"],
        "a sensor of the deformation alone shows both alike",
    ),
];

/// Why another name (or none) stands for an effect: a law that contains it as a limit, or a set.
pub fn known(effect: &Effect, named: Option<&str>) -> Option<&'static str> {
    let Some(named) = named else {
        // The noise floor of a sensor that rounds is step / sqrt(12): rounding is part of the noise.
        return (effect.name == "quantisation").then_some("what a sensor rounds away is its noise");
    };
    if effect.name == "quantisation" && named == "sensor_drift" {
        return Some(
            "under noise that is less than a step, a sensor that rounds is slowly wrong wherever the motion is slow",
        );
    }
    if effect.limits().any(|simpler| simpler.name == named) {
        return Some("the simpler law is a limit of it, and explains the recording as well");
    }
    let both = |set: &[&str]| set.contains(&effect.name) && set.contains(&named);
    SETS.iter().find(|set| both(set.0)).map(|set| set.1)
}

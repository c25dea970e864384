//! Symptoms that follow from the physics of an effect, where the standard motion does not measure them.

use super::symptoms::{OVER_AMPLITUDE, OVER_TIME, SHIFTED};

/// Each symptom, and the effects whose physics causes it.
pub const TOLD: [(&str, &[&str]); 26] = [
    (OVER_AMPLITUDE, &["cubic_stiffness", "bilinear_stiffness"]),
    (OVER_TIME, &["payload_change", "stiffness_drift"]),
    (SHIFTED, &["drive_lag", "drive_delay"]),
    (
        "waits before it moves",
        &[
            "coulomb_friction",
            "stribeck_friction",
            "stiction",
            "dead_zone",
        ],
    ),
    (
        "jerks at low speed",
        &["stribeck_friction", "stiction", "cogging"],
    ),
    (
        "falls behind in fast moves, not in slow ones",
        &[
            "saturation",
            "rate_limit",
            "torque_constant_nonlinearity",
            "drive_lag",
            "quadratic_drag",
        ],
    ),
    (
        "needs more force the faster it moves",
        &["viscous_friction", "viscous_drag", "quadratic_drag"],
    ),
    (
        "moves less easily in one direction than in the other",
        &["asymmetric_friction", "force_offset"],
    ),
    (
        "gives way more to one side than to the other",
        &["bilinear_stiffness"],
    ),
    ("knocks on reversal", &["backlash"]),
    ("knocks at one end of the travel", &["end_stop"]),
    (
        "stops elsewhere when it comes from the other side",
        &[
            "coulomb_friction",
            "presliding_hysteresis",
            "hysteretic_stiffness",
            "backlash",
        ],
    ),
    (
        "creeps on after it has stopped",
        &["viscoelastic_creep", "smooth_coulomb_friction"],
    ),
    ("error grows with time", &["sensor_drift", "clock_skew"]),
    (
        "error depends on the pose, at rest too",
        &[
            "misalignment",
            "gravity_load",
            "sensor_gain",
            "transmission_ripple",
        ],
    ),
    (
        "vibrates at a frequency that follows the speed",
        &["cogging", "transmission_ripple"],
    ),
    ("shakes most at one speed", &["transmission_ripple"]),
    (
        "vibration dies out fast at first and slowly later",
        &["quadratic_damping"],
    ),
    (
        "rings at two frequencies",
        &["second_mode", "base_mode", "swinging_load"],
    ),
    (
        "sways on at about 1 Hz after it has stopped",
        &["swinging_load"],
    ),
    ("shakes what it stands on", &["base_mode"]),
    (
        "rings more or less strongly than it should",
        &["deformation_gain"],
    ),
    (
        "rings at an instant when nothing was commanded",
        &["external_disturbance"],
    ),
    (
        "vibrates at one frequency, at rest too",
        &["harmonic_disturbance"],
    ),
    (
        "reading is smaller the faster it shakes",
        &["sensor_lag", "sensor_lag_second_order"],
    ),
    ("reading is a staircase in slow motion", &["quantisation"]),
];

/// The symptoms of the effect of this name.
pub fn told(name: &str) -> impl Iterator<Item = &'static str> + use<'_> {
    let own = TOLD.iter().filter(move |own| own.1.contains(&name));
    own.map(|own| own.0)
}

#[test]
fn the_effects_of_each_symptom_are_in_the_catalogue() {
    for name in TOLD.iter().flat_map(|own| own.1) {
        assert!(quell::effects::Effect::from_name(name).is_some(), "{name}");
    }
}

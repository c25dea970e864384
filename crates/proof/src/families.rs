//! Families of effects: which physics counts as right even if its exact name is not.
//!
//! Two effects are of one family where an engineer would look for the same part and where the motion of
//! a joint tells them apart only by detail: the shape of a friction curve, the side of the joint on which
//! an inertia hangs. A family is right when the first name that a diagnosis gives, or for two effects one
//! of its names, is of the truth's family.

/// A family and its effects.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Its name in tables.
    pub name: &'static str,
    /// Its effects.
    pub effects: &'static [&'static str],
}

/// All families of the catalogue.
pub const FAMILIES: &[Family] = &[
    family_of(
        "dry friction",
        &[
            "coulomb_friction",
            "smooth_coulomb_friction",
            "stribeck_friction",
            "presliding_hysteresis",
            "asymmetric_friction",
        ],
    ),
    family_of("hysteretic spring", &["hysteretic_stiffness"]),
    family_of("play", &["backlash", "dead_zone", "stiction"]),
    family_of("spring shape", &["cubic_stiffness", "bilinear_stiffness"]),
    family_of(
        "fluid friction",
        &[
            "viscous_friction",
            "viscous_drag",
            "quadratic_drag",
            "quadratic_damping",
        ],
    ),
    family_of("mode", &["second_mode", "base_mode", "swinging_load"]),
    family_of(
        "clock",
        &[
            "clock_offset",
            "clock_skew",
            "irregular_clock",
            "missing_samples",
        ],
    ),
    family_of(
        "sensor dynamics",
        &["sensor_lag", "sensor_lag_second_order", "sensor_delay"],
    ),
    family_of(
        "static",
        &[
            "sensor_gain",
            "deformation_gain",
            "misalignment",
            "gravity_load",
        ],
    ),
    family_of("drift of a sensor", &["sensor_drift"]),
    family_of("quantisation", &["quantisation"]),
    family_of("change in time", &["payload_change", "stiffness_drift"]),
    family_of("change with pose", &["pose_dependent_frequency"]),
    family_of("creep", &["viscoelastic_creep"]),
    family_of("periodic", &["transmission_ripple", "cogging"]),
    family_of("stop", &["end_stop"]),
    family_of("force offset", &["force_offset"]),
    family_of(
        "drive size",
        &["saturation", "torque_constant_nonlinearity", "rate_limit"],
    ),
    family_of("drive dynamics", &["drive_lag", "drive_delay"]),
    family_of("disturbance", &["external_disturbance"]),
    family_of("steady vibration", &["harmonic_disturbance"]),
];

/// The family of laws that no catalogue contains.
pub const OUTSIDE: &str = "outside";
/// The family of a learned law.
pub const LEARNED: &str = "learned law";
/// The family of a clean case, and of a diagnosis that names nothing.
pub const NOTHING: &str = "nothing";

const fn family_of(name: &'static str, effects: &'static [&'static str]) -> Family {
    Family { name, effects }
}

/// The family of an effect; [`OUTSIDE`] for one that no family holds.
pub fn family(effect: &str) -> &'static str {
    let found = FAMILIES
        .iter()
        .find(|family| family.effects.contains(&effect));
    found.map_or(OUTSIDE, |family| family.name)
}

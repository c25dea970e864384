//! Slots: the coordinate on which a law lives. A law that was learned has a slot instead of a name.
//!
//! | slot | law |
//! |---|---|
//! | `spring` | force over deformation |
//! | `damping` | damping over deformation, or over position |
//! | `friction` | force over velocity |
//! | `position` | force over position |
//! | `drive` | what arrives over what was commanded |
//! | `sensor` | reading over what is read |
//! | `pose` | natural frequency, or stiffness, over pose |
//! | `time` | anything over time |
//! | `stiffness over speed` | stiffness over the motor side's speed |
//! | `hysteresis` | force over the path that led there |

/// Laws that a diagnosis learns, and their slots.
const LEARNED: &[(&str, &[&str])] = &[
    ("learned_spring", &["spring"]),
    ("learned_damping", &["damping"]),
    ("learned_friction", &["friction"]),
    ("learned_position_force", &["position"]),
    ("learned_position_damping", &["damping"]),
    ("learned_joint_damping", &["damping"]),
    ("learned_position_friction", &["friction"]),
    ("learned_drive", &["drive"]),
    ("learned_sensor", &["sensor"]),
    ("learned_frequency", &["pose"]),
    ("learned_drift", &["time"]),
    ("learned_damping_drift", &["time"]),
    ("learned_position_stiffness", &["pose"]),
    ("learned_speed_stiffness", &["stiffness over speed"]),
    ("learned_sensor_drift", &["time"]),
    ("learned_clock", &["time"]),
    ("learned_transmission_error", &["position"]),
    ("maxwell_slip", &["hysteresis"]),
];

/// Everything else, by the name in a truth or in a verdict. Where a law has two slots a curve in either shows it.
const NAMED: &[(&[&str], &[&str])] = &[
    (
        &[
            "coulomb_friction",
            "smooth_coulomb_friction",
            "stribeck_friction",
            "asymmetric_friction",
        ],
        &["friction", "hysteresis"],
    ),
    (
        &["presliding_hysteresis", "hysteretic_stiffness"],
        &["hysteresis"],
    ),
    (
        &["backlash", "cubic_stiffness", "bilinear_stiffness"],
        &["spring"],
    ),
    (
        &[
            "viscous_friction",
            "viscous_drag",
            "quadratic_drag",
            "quadratic_damping",
        ],
        &["friction"],
    ),
    (
        &[
            "dead_zone",
            "stiction",
            "saturation",
            "torque_constant_nonlinearity",
        ],
        &["drive"],
    ),
    (
        &["cogging", "transmission_ripple", "gravity_load", "end_stop"],
        &["position"],
    ),
    (
        &["sensor_gain", "deformation_gain", "misalignment"],
        &["sensor"],
    ),
    (&["pose_dependent_frequency"], &["pose"]),
    (
        &[
            "stiffness_drift",
            "payload_change",
            "sensor_drift",
            "clock_skew",
        ],
        &["time"],
    ),
    // Outside the catalogue, this generator's.
    (&["root_speed_friction", "power_friction"], &["friction"]),
    (&["position_dependent_friction"], &["friction", "position"]),
    (&["time_varying_damping"], &["time"]),
    (&["parametric_stiffness"], &["stiffness over speed"]),
    (&["sensor_fifth_order"], &["sensor"]),
    (&["local_damper", "deformation_damper"], &["damping"]),
    (&["detent", "periodic_force"], &["position"]),
    (&["even_spring", "softening_spring"], &["spring"]),
    (&["maxwell_slip_friction"], &["hysteresis"]),
    // And of the generator in MuJoCo.
    (&["position_detents"], &["position"]),
    (
        &["fading_damping", "work_softening", "clock_jump"],
        &["time"],
    ),
    (&["patch_friction"], &["friction", "position"]),
    (&["one_way_damper"], &["friction"]),
];

/// The slots of a law; none for what has no single coordinate, such as a mode.
pub fn slots(effect: &str) -> &'static [&'static str] {
    if let Some((_, slots)) = LEARNED.iter().find(|(name, _)| *name == effect) {
        return slots;
    }
    let named = NAMED.iter().find(|(names, _)| names.contains(&effect));
    named.map_or(&[], |(_, slots)| slots)
}

/// Whether a law is one that was learned.
pub fn is_learned(effect: &str) -> bool {
    LEARNED.iter().any(|(name, _)| *name == effect)
}

/// Whether a learned law is in the slot of a hidden one.
pub fn is_learned_in_slot_of(learned: &str, hidden: &str) -> bool {
    let shared = |slot: &&str| slots(hidden).contains(slot);
    is_learned(learned) && slots(learned).iter().any(shared)
}

//! What would tell two explanations apart that no motion does: a change of payload, mounting or sensor.

use quell_model::effects::Place;

/// Effects of one group look alike in every motion; what would tell.
struct Group {
    effects: &'static [&'static str],
    remedy: &'static str,
}

const GROUPS: &[Group] = &[
    // Seen from the link, a base that rings and a second link that rings differ by their frequency only.
    Group {
        effects: &["second_mode", "base_mode"],
        remedy: "a sensor on the base, which a second mode of the arm leaves still",
    },
    // Far above the motion a mode bends with the first one.
    Group {
        effects: &["second_mode", "base_mode", "deformation_gain"],
        remedy: "faster motion, or an accelerometer beside the sensor: a mode shows at its own frequency, a gain does not",
    },
    // All are functions of the pose alone.
    Group {
        effects: &[
            "sensor_gain",
            "misalignment",
            "gravity_load",
            "deformation_gain",
            "pose_dependent_frequency",
        ],
        remedy: "turning the axis' mounting, which gravity does not follow, or remounting the sensor, whose \
                 errors go with it",
    },
    // A lag, a delay and drag are the same to first order: a shift in time.
    Group {
        effects: &[
            "clock_skew",
            "sensor_delay",
            "sensor_lag",
            "sensor_lag_second_order",
            "drive_lag",
            "drive_delay",
            "viscous_drag",
            "viscous_friction",
        ],
        remedy: "a common trigger for all clocks, which leaves no offset free, or another payload, which drag \
                 depends on and a lag does not",
    },
    // They differ in what happens at rest and at the lowest speeds.
    Group {
        effects: &[
            "coulomb_friction",
            "stribeck_friction",
            "stiction",
            "asymmetric_friction",
            "presliding_hysteresis",
            "hysteretic_stiffness",
        ],
        remedy: "slower and smaller motion than was recorded, seen by a sensor of less noise",
    },
];

/// What would tell explanations with these effects apart, the first that applies.
pub fn advice(one: &[(&str, Place)], other: &[(&str, Place)]) -> &'static str {
    let has = |side: &[(&str, Place)], group: &Group| {
        side.iter().any(|effect| group.effects.contains(&effect.0))
    };
    let group = GROUPS
        .iter()
        .find(|group| has(one, group) && has(other, group));
    let at = |side: &[(&str, Place)], place: Place| side.iter().any(|effect| effect.1 == place);
    let only = |place: Place| at(one, place) != at(other, place);
    match group {
        Some(group) => group.remedy,
        None if only(Place::Sensor) => {
            "a second sensor beside the first: both show what the machine does, only one what it adds"
        }
        None if only(Place::Base) => "a sensor on the base",
        None if only(Place::Drive) => "the current of the motor, or a sensor at the drive",
        None => "another payload, or a sensor of less noise",
    }
}

//! The metrics of each joint.

use crate::service::contract::{JointSnapshot, WatchdogState};

/// Name, description, and value if it is known.
type Metric = (
    &'static str,
    &'static str,
    fn(&JointSnapshot) -> Option<f64>,
);

/// All metrics of a joint with a single value.
pub const JOINT: [Metric; 17] = [
    ("command_radians", "Commanded position.", |j| {
        Some(j.command_rad)
    }),
    ("motor_radians", "Last motor position.", |j| j.motor_rad),
    ("deformation_radians", "Last deformation.", |j| {
        j.deformation_rad
    }),
    (
        "estimate_frequency_hertz",
        "Estimated natural frequency.",
        |j| Some(j.estimate.as_ref()?.frequency_hz),
    ),
    (
        "estimate_frequency_std_hertz",
        "One standard deviation of the natural frequency.",
        |j| Some(j.estimate.as_ref()?.frequency_std_hz),
    ),
    ("estimate_damping_ratio", "Estimated damping ratio.", |j| {
        Some(j.estimate.as_ref()?.damping_ratio)
    }),
    (
        "estimate_converged",
        "Whether the estimate has settled.",
        |j| Some(flag(j.estimate.as_ref()?.converged)),
    ),
    (
        "mode_frequency_hertz",
        "Natural frequency that is shaped for.",
        |j| Some(j.mode?.frequency_hz),
    ),
    ("shaping", "Whether plans are shaped.", |j| {
        Some(flag(j.shaping))
    }),
    (
        "adaptation",
        "Whether the train follows the estimate.",
        |j| Some(flag(j.adaptation && !j.adaptation_frozen)),
    ),
    (
        "retunes_total",
        "Trains changed because of an estimate.",
        |j| Some(j.retunes as f64),
    ),
    ("corrections_total", "Corrections in motion.", |j| {
        Some(j.corrections as f64)
    }),
    (
        "corrections_refused_total",
        "Corrections refused since none kept the limits.",
        |j| Some(j.corrections_refused as f64),
    ),
    ("known_modes", "Modes that moves have taught.", |j| {
        Some(j.learning.modes.len() as f64)
    }),
    (
        "held",
        "Whether the train is not followed in motion, being solved for what moves have taught.",
        |j| Some(flag(j.learning.held.is_some())),
    ),
    (
        "expected_ratio",
        "Share of the unshaped vibration that the last train was expected to leave.",
        |j| Some(j.learning.expected_percent? / 100.0),
    ),
    (
        "watchdog",
        "Whether measurements come (0), are missing (1), or missing and the joint stopped (2).",
        |j| Some(watchdog(j.watchdog)),
    ),
];

/// 1 for true.
pub fn flag(value: bool) -> f64 {
    f64::from(u8::from(value))
}

fn watchdog(state: WatchdogState) -> f64 {
    match state {
        WatchdogState::Fine => 0.0,
        WatchdogState::Silent => 1.0,
        WatchdogState::Stopped => 2.0,
    }
}

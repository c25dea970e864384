//! Effects that no catalogue of the usual physics holds.

use super::super::Channel;
use super::super::surfaces::DryFriction;
use super::{ANY, Arm, Entry, Parameters, Scales, between, entry, log_between, sign};
use std::f64::consts::TAU;

pub(super) const ENTRIES: &[Entry] = &[
    entry(
        "root_speed_friction",
        "transmission",
        [0.05, 1.0],
        root_speed,
    )
    .unknown(),
    entry(
        "parametric_stiffness",
        "transmission",
        [0.1, 0.6],
        parametric,
    )
    .unknown(),
    entry(
        "time_varying_damping",
        "transmission",
        [0.5, 0.95],
        waving_damping,
    )
    .unknown()
    .in_a_programme(),
    entry(
        "position_dependent_friction",
        "transmission",
        [0.05, 0.8],
        waving_friction,
    )
    .unknown()
    .in_a_programme(),
    entry("sensor_fifth_order", "sensor", [0.1, 1.0], fifth)
        .unknown()
        .seen_by(ANY),
];

/// Friction with the root of the speed.
fn root_speed(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64) -> Parameters {
    let friction = size * scales.deformation / scales.rate.sqrt();
    arm.joint.root_damping = friction * arm.joint.stiffness;
    vec![("friction", friction)]
}

/// A spring that is stiffer while the motor turns.
fn parametric(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64) -> Parameters {
    arm.joint.speed_stiffening = size / scales.speed;
    vec![("per_speed", arm.joint.speed_stiffening)]
}

/// Damping that comes and goes.
fn waving_damping(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let frequency = TAU * between(1.0, 3.0, shape[0]) / scales.duration;
    arm.joint.damping_waves = [size, frequency];
    vec![("depth", size), ("frequency_hz", frequency / TAU)]
}

/// Dry friction that rises and falls along the way.
fn waving_friction(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let friction = size * scales.deformation;
    let waves = [
        between(0.7, 1.0, shape[0]),
        log_between(5.0, 25.0, shape[1]),
    ];
    arm.joint.dry = Some(DryFriction {
        waves,
        ..DryFriction::coulomb(friction * arm.joint.stiffness)
    });
    vec![
        ("friction", friction),
        ("depth", waves[0]),
        ("order", waves[1]),
    ]
}

/// A sensor that bends at the ends of its range.
fn fifth(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let range = match arm.channel {
        Channel::Deformation => scales.deformation,
        Channel::Tip | Channel::Link => scales.span[1].max(-scales.span[0]),
    };
    arm.faults.fifth = [sign(shape[0]) * size * scales.deformation, range];
    vec![("error_at_range", arm.faults.fifth[0]), ("range", range)]
}

//! Effects between the motor side and the link. Forces are told divided by the stiffness, in rad.

use super::super::surfaces::{BoucWen, Bristles, DryFriction, Gap};
use super::{Arm, Entry, Parameters, Scales, between, entry, log_between, sign};
use std::f64::consts::TAU;

const PLACE: &str = "transmission";

pub(super) const ENTRIES: &[Entry] = &[
    entry("coulomb_friction", PLACE, [0.05, 0.8], coulomb),
    entry("stribeck_friction", PLACE, [0.05, 0.6], stribeck).more_than(only_coulomb),
    entry("asymmetric_friction", PLACE, [0.05, 0.6], asymmetric).more_than(only_coulomb),
    entry("presliding_hysteresis", PLACE, [0.05, 0.8], presliding).more_than(only_coulomb),
    entry("hysteretic_stiffness", PLACE, [0.1, 0.5], bouc_wen).more_than(only_dahl),
    entry("backlash", PLACE, [0.05, 0.8], backlash),
    entry("cubic_stiffness", PLACE, [0.1, 3.0], cubic),
    entry("bilinear_stiffness", PLACE, [0.05, 0.5], bilinear),
    entry("quadratic_damping", PLACE, [0.1, 3.0], quadratic_damping),
    entry("transmission_ripple", PLACE, [0.03, 0.5], ripple),
    entry("stiffness_drift", PLACE, [0.05, 0.4], drift).in_a_programme(),
    entry("viscoelastic_creep", PLACE, [0.05, 0.6], creep),
];

fn coulomb(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64) -> Parameters {
    let friction = size * scales.deformation;
    arm.joint.dry = Some(DryFriction::coulomb(friction * arm.joint.stiffness));
    vec![("friction", friction)]
}

pub(super) fn only_coulomb(
    arm: &mut Arm,
    scales: &Scales,
    shape: [f64; 4],
    size: f64,
    by: [f64; 2],
) {
    coulomb(arm, scales, shape, size * by[0]);
}

fn stribeck(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let friction = size * scales.deformation;
    let breakaway = between(1.4, 2.5, shape[0]);
    let stribeck_velocity = scales.rate * log_between(0.02, 0.3, shape[1]);
    arm.joint.dry = Some(DryFriction {
        breakaway,
        stribeck_velocity,
        ..DryFriction::coulomb(friction * arm.joint.stiffness)
    });
    vec![
        ("friction", friction),
        ("excess", breakaway - 1.0),
        ("stribeck_velocity", stribeck_velocity),
    ]
}

fn asymmetric(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let uneven = sign(shape[0]) * between(0.3, 0.9, shape[1]);
    let sides = [1.0 + uneven, 1.0 - uneven].map(|side| side * size * scales.deformation);
    arm.joint.dry = Some(DryFriction {
        kinetic: sides.map(|friction| friction * arm.joint.stiffness),
        ..DryFriction::coulomb(0.0)
    });
    vec![
        ("friction", size * scales.deformation),
        ("asymmetry", uneven),
    ]
}

/// Dahl's friction for half of the shapes, LuGre's with a Stribeck curve for the others.
fn presliding(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let friction = size * scales.deformation;
    let distance = scales.deformation * log_between(0.01, 0.15, shape[0]);
    let (kinetic, stiffness) = (friction * arm.joint.stiffness, arm.joint.stiffness);
    let dahl = shape[1] < 0.5;
    arm.joint.bristles = Some(Bristles {
        stiffness: kinetic / distance,
        damping: if dahl {
            0.0
        } else {
            0.3 * stiffness * size / scales.natural_frequency
        },
        kinetic,
        breakaway: if dahl {
            1.0
        } else {
            between(1.0, 1.4, shape[2])
        },
        stribeck_velocity: scales.rate * between(0.05, 0.3, shape[3]),
    });
    // Without a Stribeck curve and a damping of their own the bristles are Dahl's.
    let [force, length] = match dahl {
        true => ["friction", "presliding_distance"],
        false => ["kinetic_friction", "bristle_distance"],
    };
    vec![(force, friction), (length, distance)]
}

/// The loop beside the spring; told as a share of the sum of both. It unloads so that it never gives
/// back more than it took.
fn bouc_wen(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let distance = scales.deformation * log_between(0.08, 0.6, shape[0]);
    let lean = between(0.5, 1.0, shape[1]);
    arm.joint.hysteresis = Some(BoucWen {
        stiffness: size * arm.joint.stiffness,
        beta: lean / distance,
        gamma: (1.0 - lean) / distance,
    });
    vec![
        ("share", size / (1.0 + size)),
        ("yield_deformation", distance),
        ("unloading", 2.0 * lean - 1.0),
    ]
}

/// Without a lean the loop is that of Dahl's friction.
fn only_dahl(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64, by: [f64; 2]) {
    bouc_wen(arm, scales, [shape[0], 1.0, 0.0, 0.0], size);
    if let Some(law) = &mut arm.joint.hysteresis {
        law.stiffness *= by[0] / by[1];
        law.beta /= by[1];
    }
}

pub(super) fn backlash(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let half = 0.5 * size * scales.deformation;
    let oil = between(0.0, 0.3, shape[0]);
    arm.joint.gap = Some(Gap { half, oil });
    vec![("gap", 2.0 * half)]
}

/// Softening stays clear of a spring whose slope vanishes.
fn cubic(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let size = if shape[0] < 0.7 { size } else { -size.min(0.2) };
    arm.joint.cubic = size * scales.deformation.powi(-2);
    vec![("k3", arm.joint.cubic)]
}

/// One-sided, or with a knee on either side.
fn bilinear(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let change = sign(shape[0]) * size;
    if shape[1] < 0.5 {
        arm.joint.bilinear = [change, -change, 0.0];
        return vec![("one_sided_change", change)];
    }
    // Beyond the knee less is bent, so that more must change; softer by a half at most.
    let change = (2.0 * change).max(-0.5);
    let knee = scales.deformation * between(0.1, 0.5, shape[2]);
    arm.joint.bilinear = [change, change, knee];
    vec![("change", change), ("knee", knee)]
}

pub(super) fn quadratic_damping(
    arm: &mut Arm,
    scales: &Scales,
    _: [f64; 4],
    size: f64,
) -> Parameters {
    let damping = size * scales.deformation / scales.rate.powi(2);
    arm.joint.quadratic_damping = damping * arm.joint.stiffness;
    vec![("coefficient", damping)]
}

pub(super) fn ripple(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let waves = log_between(8.0, 80.0, shape[0]);
    arm.joint.ripple = [size * scales.deformation, waves, TAU * shape[1]];
    vec![
        ("amplitude", size * scales.deformation),
        ("order", waves),
        ("phase", TAU * shape[1]),
    ]
}

fn drift(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let time_constant = scales.duration * log_between(0.5, 4.0, shape[0]);
    let end = 1.0 - (-scales.duration / time_constant).exp();
    arm.joint.warming = [sign(shape[1]) * size / end, time_constant];
    vec![
        ("change", sign(shape[1]) * size),
        ("time_constant", time_constant),
    ]
}

fn creep(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let time_constant = log_between(4.0, 60.0, shape[0]) / scales.natural_frequency;
    arm.joint.creep = Some([size * arm.joint.stiffness, time_constant]);
    vec![
        ("relative_stiffness", size),
        ("time_constant", time_constant),
    ]
}

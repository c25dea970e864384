//! Effects on the link, under the base and from outside.

use super::super::joint::{Body, Hose};
use super::super::surfaces::{DryFriction, Knock, Stop};
use super::{Arm, Entry, OUTER, Parameters, Scales, between, entry, log_between, sign};
use std::f64::consts::{PI, TAU};

const PLACE: &str = "link";

pub(super) const ENTRIES: &[Entry] = &[
    entry("coulomb_friction", PLACE, [0.05, 0.8], bearing),
    entry("smooth_coulomb_friction", PLACE, [0.05, 0.8], creeping).more_than(only_bearing),
    entry("viscous_drag", PLACE, [0.1, 1.0], viscous_drag),
    entry("quadratic_drag", PLACE, [0.1, 1.0], quadratic_drag),
    entry("gravity_load", PLACE, [0.1, 1.0], gravity),
    entry("second_mode", PLACE, [0.15, 0.6], second_mode).more_than(only_its_flexibility),
    entry("swinging_load", PLACE, [0.05, 0.6], load).more_than(swaying),
    entry("pose_dependent_frequency", PLACE, [0.1, 0.5], pose).in_a_programme(),
    entry("payload_change", PLACE, [0.1, 0.8], payload).in_a_programme(),
    entry("end_stop", PLACE, [0.3, 1.5], end_stop).in_a_programme(),
    entry("base_mode", "base", [0.05, 0.5], base_mode).seen_by(OUTER),
    entry("external_disturbance", "environment", [0.1, 2.0], knocks),
    entry("harmonic_disturbance", "environment", [0.02, 0.4], shaker),
];

/// Dry friction in the link's bearing.
fn bearing(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64) -> Parameters {
    let friction = size * scales.deformation;
    arm.joint.dry = Some(DryFriction::coulomb(friction * arm.joint.stiffness));
    arm.joint.dry_bearing = true;
    vec![("friction", friction)]
}

/// The same without sticking.
fn creeping(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let friction = size * scales.deformation;
    let transition = scales.speed * log_between(0.003, 0.1, shape[0]);
    arm.joint.creeping_bearing = [friction * arm.joint.stiffness, transition];
    vec![("friction", friction), ("transition_velocity", transition)]
}

fn only_bearing(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64, by: [f64; 2]) {
    bearing(arm, scales, shape, size * by[0]);
}

fn viscous_drag(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64) -> Parameters {
    let drag = size * scales.deformation / scales.speed;
    arm.joint.viscous_drag = drag * arm.joint.stiffness;
    vec![("viscous", drag)]
}

fn quadratic_drag(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64) -> Parameters {
    let drag = size * scales.deformation / scales.speed.powi(2);
    arm.joint.quadratic_drag = drag * arm.joint.stiffness;
    vec![("coefficient", drag)]
}

fn gravity(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let load = size * scales.deformation;
    arm.joint.gravity = [load * arm.joint.stiffness, TAU * shape[0]];
    vec![("amplitude", load)]
}

/// Two bodies in a chain; the size is the outer one's share of the inertia.
fn second_mode(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let frequency = scales.natural_frequency * outer_ratio(shape);
    let damping_ratio = log_between(0.005, 0.05, shape[1]);
    let outer = hung(size * arm.joint.inertia, frequency, damping_ratio);
    let inner = (1.0 - size) * arm.joint.inertia;
    let high = upper_frequency(
        [inner, outer.inertia],
        [arm.joint.stiffness, outer.stiffness],
    );
    arm.joint.outer = Some((outer, on_outer(shape)));
    vec![("natural_frequency", high), ("inertia_share", size)]
}

/// Frequency of the outer body on its own spring, over the joint's.
fn outer_ratio(shape: [f64; 4]) -> f64 {
    log_between(1.8, 5.0, shape[0])
}

/// Whether the sensor's target is on the outer body.
fn on_outer(shape: [f64; 4]) -> bool {
    shape[2] < 0.6
}

/// Far above the motion a further spring only bends with the first one; a sensor on the inner body misses that.
fn only_its_flexibility(arm: &mut Arm, _: &Scales, shape: [f64; 4], _: f64, by: [f64; 2]) {
    let seen = if on_outer(shape) { 1.0 } else { -1.0 };
    arm.faults.deformation_gain = seen * by[0] / outer_ratio(shape).powi(2);
}

/// A load that hangs on the link and swings far.
fn load(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let frequency = TAU * between(0.6, 2.0, shape[0]);
    let push = scales.deformation * scales.natural_frequency.powi(2);
    // The greatest acceleration turns it by about a radian.
    let length_ratio = frequency * frequency / push * between(0.6, 1.5, shape[2]);
    arm.joint.hose = Some(Hose {
        frequency,
        damping_ratio: between(0.02, 0.15, shape[1]),
        share: size,
        length_ratio,
    });
    vec![
        ("natural_frequency", frequency),
        ("mass_ratio", size * length_ratio),
    ]
}

/// The same with small swings.
fn swaying(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64, by: [f64; 2]) {
    const LESS: f64 = 1e-3;
    load(arm, scales, shape, size * by[0] / LESS);
    if let Some(hose) = &mut arm.joint.hose {
        hose.length_ratio *= LESS;
        hose.frequency *= by[1];
    }
}

/// A body whose own spring gives it this frequency (rad/s) and damping ratio.
fn hung(inertia: f64, frequency: f64, damping_ratio: f64) -> Body {
    Body {
        inertia,
        stiffness: inertia * frequency * frequency,
        damping: 2.0 * damping_ratio * frequency * inertia,
    }
}

/// The higher of the two frequencies of a chain, rad/s: ground, k1, m1, k2, m2.
fn upper_frequency([m1, m2]: [f64; 2], [k1, k2]: [f64; 2]) -> f64 {
    let (sum, product) = ((k1 + k2) / m1 + k2 / m2, k1 * k2 / (m1 * m2));
    (0.5 * (sum + (sum * sum - 4.0 * product).sqrt())).sqrt()
}

fn pose(arm: &mut Arm, _: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    arm.joint.pose = [size, TAU * shape[0]];
    vec![("inertia_change", size), ("phase", TAU * shape[0])]
}

/// A load is taken up in one of the pauses.
fn payload(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let inner = scales.pauses.len().saturating_sub(2).max(1);
    let pick = 1 + ((inner as f64 * shape[0]) as usize).min(inner - 1);
    let [start, end] = scales.pauses.get(pick).copied().unwrap_or([0.0, 1.0]);
    let time = between(start, end, between(0.3, 0.9, shape[1]));
    arm.joint.payload = Some([time, size]);
    vec![("time", time), ("change", size)]
}

/// A greater size moves the stop into the link's way.
fn end_stop(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let position = scales.span[1] + (1.0 - size) * scales.deformation;
    let hardness = log_between(2.0, 20.0, shape[0]);
    let impact = scales.rate * log_between(2.0, 20.0, shape[1]);
    arm.joint.stop = Some(Stop {
        position,
        stiffness: hardness * arm.joint.stiffness,
        dissipation: 1.0 / impact,
    });
    vec![("position", position), ("stiffness", hardness)]
}

/// The size is the link's inertia over that of the base.
fn base_mode(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let frequency = scales.natural_frequency * log_between(1.3, 5.0, shape[0]);
    let damping_ratio = log_between(0.01, 0.1, shape[1]);
    let base = hung(arm.joint.inertia / size, frequency, damping_ratio);
    arm.joint.base = Some(base);
    vec![
        ("base_frequency_hz", frequency / TAU),
        ("base_damping_ratio", damping_ratio),
        ("inertia_share", size),
    ]
}

/// One knock to three, anywhere in the recording.
fn knocks(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let count = 1 + (3.0 * shape[0] * shape[0]) as usize;
    let jump = size * scales.deformation * scales.natural_frequency;
    let mut parameters = Vec::new();
    let names = ["time", "time_2", "time_3"];
    for (index, name) in names.into_iter().take(count).enumerate() {
        let place = (shape[1] + index as f64 * 0.382).fract();
        let start = scales.duration * between(0.1, 0.85, place);
        let length = between(0.005, 0.02, (shape[2] + index as f64 * 0.618).fract());
        // The mean of half a sine is 2 / pi of its height.
        let force = sign((shape[3] + index as f64 * 0.29).fract()) * jump * arm.joint.inertia
            / (length * 2.0 / PI);
        arm.joint.knocks.push(Knock {
            start,
            length,
            force,
        });
        parameters.push((name, start + 0.5 * length));
        if count == 1 {
            parameters.push(("jump", jump * sign(shape[3])));
        }
    }
    // Signs differ from knock to knock.
    if count > 1 {
        parameters.push(("jump_size", jump));
    }
    parameters
}

/// A machine next door; the size is the static deflection by its force.
fn shaker(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let frequency = scales.natural_frequency * log_between(0.4, 4.0, shape[0]);
    let amplitude = size * scales.deformation;
    arm.joint.shaking = [amplitude * arm.joint.stiffness, frequency, TAU * shape[1]];
    vec![("amplitude", amplitude), ("frequency", frequency)]
}

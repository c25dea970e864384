//! Laws that no catalogue holds but that have one coordinate, so that a curve over it can be learned. Where a law
//! of the catalogue comes near one of them, it is hidden only where it shows as more than that.

use super::super::laws::{Bell, Detent, PowerFriction, SLIDERS, Slider};
use super::transmission;
use super::{Arm, Entry, Parameters, Scales, between, entry, log_between, sign};
use std::f64::consts::TAU;

const PLACE: &str = "transmission";

pub(super) const ENTRIES: &[Entry] = &[
    entry("local_damper", PLACE, [0.3, 6.0], local_damper)
        .unknown()
        .in_a_programme(),
    entry("deformation_damper", PLACE, [0.3, 6.0], deformation_damper).unknown(),
    entry("detent", "link", [0.1, 1.5], detent)
        .unknown()
        .in_a_programme(),
    entry("even_spring", PLACE, [0.05, 0.4], even_spring)
        .unknown()
        .more_than(only_one_sided),
    entry("softening_spring", PLACE, [0.3, 0.9], softening_spring)
        .unknown()
        .more_than(only_softening_cubic),
    entry("power_friction", PLACE, [0.05, 1.0], power_friction)
        .unknown()
        .more_than(only_textbook_friction),
    entry("maxwell_slip_friction", PLACE, [0.05, 0.8], maxwell_slip)
        .unknown()
        .more_than(only_dahl),
    entry("periodic_force", "link", [0.03, 0.6], periodic_force)
        .unknown()
        .in_a_programme()
        .more_than(only_a_ripple),
];

/// A place from a tenth to nine tenths of the way.
fn on_the_way(scales: &Scales, share: f64) -> f64 {
    between(scales.span[0], scales.span[1], between(0.1, 0.9, share))
}

/// A damper that acts near one position of the motor side.
fn local_damper(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let damping = size * scales.deformation / scales.rate;
    let place = on_the_way(scales, shape[0]);
    let travel = scales.span[1] - scales.span[0];
    let width = travel * between(0.03, 0.15, shape[1]);
    arm.joint.laws.local_damper = Some(Bell {
        height: damping * arm.joint.stiffness,
        place,
        width,
    });
    vec![("damping", damping), ("position", place), ("width", width)]
}

/// A damper that grows with the squared deformation.
fn deformation_damper(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64) -> Parameters {
    let damping = size / (scales.rate * scales.deformation);
    arm.joint.bent_damping = damping * arm.joint.stiffness;
    vec![("coefficient", damping)]
}

fn detent(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let depth = size * scales.deformation;
    let place = on_the_way(scales, shape[0]);
    let width = log_between(0.015, 0.06, shape[1]);
    arm.joint.laws.detent = Some(Detent {
        depth: depth * arm.joint.stiffness,
        place,
        width,
    });
    vec![("force", depth), ("position", place), ("width", width)]
}

/// A square, or a power near it. A power of one is the catalogue's one-sided change.
fn even_spring(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let power = if shape[0] < 0.5 {
        2.0
    } else {
        between(1.5, 3.0, shape[1])
    };
    let coefficient = sign(shape[2]) * size * scales.deformation.powf(1.0 - power);
    arm.joint.even = [coefficient, power];
    vec![("coefficient", coefficient), ("power", power)]
}

fn only_one_sided(arm: &mut Arm, _: &Scales, shape: [f64; 4], size: f64, by: [f64; 2]) {
    let change = sign(shape[2]) * 0.7 * size * by[0];
    arm.joint.bilinear = [change, -change, 0.0];
}

/// The size is the greatest deformation of the straight spring over that of the bend.
fn softening_spring(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64) -> Parameters {
    let bend = scales.deformation / size;
    arm.joint.softening = bend;
    vec![("bend", bend)]
}

/// The first two terms of the series of the arc tangent.
fn only_softening_cubic(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64, by: [f64; 2]) {
    arm.joint.cubic = -(size / scales.deformation).powi(2) / 3.0 * by[0];
}

/// A power well apart from 0 (Coulomb), 1 (viscous) and 2 (quadratic).
fn power_friction(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let power = match shape[0] {
        low if low < 0.5 => between(0.4, 0.75, 2.0 * low),
        high => between(1.3, 1.6, 2.0 * high - 1.0),
    };
    let coefficient = size * scales.deformation / scales.rate.powf(power);
    arm.joint.laws.power_friction = Some(PowerFriction {
        coefficient: coefficient * arm.joint.stiffness,
        power,
        linear_below: 0.01 * scales.rate,
    });
    vec![("coefficient", coefficient), ("power", power)]
}

/// Of a low power Coulomb's friction, of a high one the quadratic damping.
fn only_textbook_friction(
    arm: &mut Arm,
    scales: &Scales,
    shape: [f64; 4],
    size: f64,
    by: [f64; 2],
) {
    if shape[0] < 0.5 {
        transmission::only_coulomb(arm, scales, shape, 0.5 * size, by);
    } else {
        transmission::quadratic_damping(arm, scales, shape, 0.5 * size * by[0]);
    }
}

/// Sliders from a twentieth of the deformation to about all of it, of unequal strength.
fn maxwell_slip(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let friction = size * scales.deformation;
    let weights = shape.map(|share| between(0.3, 1.0, share));
    let whole: f64 = weights.iter().sum();
    let slider = |(k, weight): (usize, f64)| {
        let share = (k as f64 + shape[3 - k]) / SLIDERS as f64;
        let level = friction * arm.joint.stiffness * weight / whole;
        Slider {
            stiffness: level / (scales.deformation * log_between(0.05, 1.0, share)),
            time_constant: 5e-4,
            level,
        }
    };
    arm.joint.laws.sliders = weights.into_iter().enumerate().map(slider).collect();
    vec![("friction", friction), ("elements", SLIDERS as f64)]
}

/// Dahl's friction of the same size, its distance in the middle of the sliders'.
fn only_dahl(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64, by: [f64; 2]) {
    let distance = 0.25 * scales.deformation * by[1];
    arm.joint.hysteresis = Some(super::super::surfaces::BoucWen {
        stiffness: size * by[0] * scales.deformation * arm.joint.stiffness / distance,
        beta: 1.0 / distance,
        gamma: 0.0,
    });
}

/// Four harmonics of about the same size: no one wave comes near their sum.
fn periodic_force(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let force = size * scales.deformation;
    let order = log_between(4.0, 20.0, shape[0]);
    let wave = |(k, share): (usize, f64)| {
        let amplitude = force * arm.joint.stiffness * between(0.6, 1.0, share);
        [
            amplitude,
            order * (k + 1) as f64,
            TAU * (share * 7.0).fract(),
        ]
    };
    arm.joint.laws.waves = shape.into_iter().enumerate().map(wave).collect();
    vec![("force", force), ("order", order), ("harmonics", 4.0)]
}

/// The first of the waves.
fn only_a_ripple(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64, by: [f64; 2]) {
    periodic_force(arm, scales, shape, size * by[0]);
    arm.joint.laws.waves.truncate(1);
}

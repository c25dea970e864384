//! Named physics whose law has not the textbook's shape. Each is hidden only where it shows as more than that.

use super::super::laws::Slider;
use super::super::surfaces::RoundedGap;
use super::transmission;
use super::{Arm, Entry, Parameters, Scales, between, entry, log_between, sign};
use std::f64::consts::TAU;

const PLACE: &str = "transmission";

pub(super) const ENTRIES: &[Entry] = &[
    entry("coulomb_friction", PLACE, [0.05, 0.8], compliant_friction)
        .shaped("over a contact with compliance", transmission::only_coulomb),
    entry("backlash", PLACE, [0.05, 0.8], rounded_backlash)
        .shaped("with round edges", only_backlash),
    entry("transmission_ripple", PLACE, [0.03, 0.5], ripple).shaped("with harmonics", only_a_sine),
    entry("cubic_stiffness", PLACE, [0.1, 3.0], third_and_fifth)
        .shaped("with a term of fifth order", only_cubic),
];

/// Kelvin and Voigt's contact: it bends before it slides, and is damped.
fn compliant_friction(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let friction = size * scales.deformation;
    let distance = scales.deformation * log_between(0.005, 0.08, shape[0]);
    let time_constant = log_between(5e-4, 4e-3, shape[1]);
    let level = friction * arm.joint.stiffness;
    arm.joint.laws.sliders = vec![Slider {
        stiffness: level / distance,
        time_constant,
        level,
    }];
    vec![
        ("friction", friction),
        ("contact_deflection", distance),
        ("contact_time_constant", time_constant),
    ]
}

fn rounded_backlash(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let half = 0.5 * size * scales.deformation;
    let radius = half * between(0.2, 0.8, shape[0]);
    arm.joint.rounded_gap = Some(RoundedGap {
        half,
        radius,
        oil: between(0.0, 0.3, shape[1]),
    });
    vec![("rounded_gap", 2.0 * half), ("radius", radius)]
}

fn only_backlash(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64, by: [f64; 2]) {
    transmission::backlash(arm, scales, [shape[1], 0.0, 0.0, 0.0], size * by[0]);
}

/// The second and the third harmonic beside the first wave.
fn ripple(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let first = transmission::ripple(arm, scales, [log_share(shape[0]), shape[1], 0.0, 0.0], size);
    let [amplitude, waves, phase] = arm.joint.ripple;
    let harmonic = |order: f64, share: f64, turn: f64| {
        let phase = phase + TAU * turn;
        [amplitude * share / order, order * waves, phase]
    };
    let shares = [between(0.5, 1.2, shape[2]), between(0.3, 1.0, shape[3])];
    arm.joint.harmonics = vec![
        harmonic(2.0, shares[0], shape[3]),
        harmonic(3.0, shares[1], shape[2]),
    ];
    let further = [
        ("second_harmonic", 0.5 * shares[0]),
        ("third_harmonic", shares[1] / 3.0),
    ];
    first.into_iter().chain(further).collect()
}

/// The longer half of the waves: the third harmonic of the shortest is then one of a gear, too.
fn log_share(share: f64) -> f64 {
    0.5 * share
}

fn only_a_sine(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64, by: [f64; 2]) {
    let shape = [log_share(shape[0]), shape[1], 0.0, 0.0];
    transmission::ripple(arm, scales, shape, size * by[0]);
}

/// A hardening spring of both orders, or one that softens before it hardens.
fn third_and_fifth(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let third = sign(shape[0]) * size.min(if shape[0] < 0.5 { size } else { 0.3 });
    let fifth = size * between(0.5, 1.5, shape[1]);
    arm.joint.cubic = third * scales.deformation.powi(-2);
    arm.joint.fifth = fifth * scales.deformation.powi(-4);
    vec![
        ("third_order", arm.joint.cubic),
        ("fifth_order", arm.joint.fifth),
    ]
}

/// Started from what a cubic must do in place of both.
fn only_cubic(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64, by: [f64; 2]) {
    arm.joint.cubic = size * by[0] * scales.deformation.powi(-2);
}

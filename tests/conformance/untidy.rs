//! Two laws at once, neither of the shape of the catalogue.

use crate::machines::{PERIOD, position, stamps, two_angles};
use quell::diagnosis::{Options, diagnose};
use quell::model::Model;
use quell::recording::Role;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Steps between two samples.
const STEPS: u32 = 80;
/// Natural frequency of the closed gap, rad/s.
const FREQUENCY: f64 = 9.6 * TAU;
const DAMPING_RATIO: f64 = 0.045;
/// Whole width of the gap, rad.
const GAP: f64 = 1.2e-3;
/// Width over which its edges are rounded, rad.
const EDGE: f64 = 5e-5;
/// Friction of the bearing over the joint's stiffness, rad.
const FRICTION: f64 = 4e-5;
/// Deflection of its bristles, rad.
const BRISTLE: f64 = 5e-4;
/// Noise of the link's sensor, rad.
const NOISE: f64 = 1e-5;

/// Deformation of the spring behind a gap with rounded edges.
fn behind_gap(deformation: f64) -> f64 {
    let edge = |side: f64| (deformation - 0.5 * side * GAP).hypot(EDGE);
    deformation + 0.5 * (edge(1.0) - edge(-1.0))
}

/// Motor side and link of a joint with a gap, whose oil damps in the gap as well, and with bristles in the link's bearing
/// (Canudas de Wit et al. 1995), by Euler's symplectic rule.
fn motion() -> [Vec<f64>; 2] {
    let h = PERIOD / f64::from(STEPS);
    let [mut y, mut v, mut bristle] = [0.0_f64; 3];
    let mut sides = [Vec::new(), Vec::new()];
    for sample in 0..stamps(PERIOD).len() as u32 {
        let at = |step: u32| position(f64::from(sample * STEPS + step) * h);
        sides[0].push(at(0));
        sides[1].push(y);
        for step in 0..STEPS {
            let (u, speed) = (at(step), (at(step + 1) - at(step)) / h);
            let spring = behind_gap(y - u) + 2.0 * DAMPING_RATIO / FREQUENCY * (v - speed);
            bristle += h * (v - v.abs() * bristle / BRISTLE);
            v -= h * FREQUENCY.powi(2) * (spring + FRICTION * bristle / BRISTLE);
            y += h * v;
        }
    }
    sides
}

/// No law alone explains much, and no two of the catalogue leave only noise: both are told none the less.
#[test]
fn a_gap_and_a_friction_are_told_though_neither_has_the_textbooks_shape() {
    let [motor, link] = motion();
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut noisy = |y: f64| -> f64 {
        let white: f64 = StandardNormal.sample(&mut random);
        y + NOISE * white
    };
    let link = link.into_iter().map(&mut noisy).collect();
    let angles = [(Role::MotorPosition, motor), (Role::LinkPosition, link)];
    let recording = two_angles("untidy", &stamps(PERIOD), angles);
    let model = "kind = \"flexible_joint\"\nnatural_frequency_hz = 9.2\ndamping_ratio = 0.033\n";
    let model = Model::from_toml(model, "model.toml").unwrap();
    let said = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {})
        .unwrap()
        .diagnosis;
    println!("{}", said.summary);
    let find = |name: &str, place: &str| {
        let mut all = said.findings.iter();
        all.find(|own| own.effect == name && own.place == place)
    };
    let gap = find("backlash", "transmission").expect("a gap is told");
    let gap = gap.parameters[0].value;
    assert!((gap / GAP - 1.0).abs() < 0.1, "{gap} for {GAP}");
    let bristles = find("presliding_hysteresis", "link").expect("bristles are told");
    let force = bristles.parameters[0].value;
    assert!(
        (force / FRICTION - 1.0).abs() < 0.25,
        "{force} for {FRICTION}"
    );
}

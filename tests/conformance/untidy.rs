//! Laws whose shape the catalogue does not have.

use crate::machines::{position, two_angles};
use quell::diagnosis::{Diagnosis, Options, diagnose};
use quell::model::Model;
use quell::recording::Role;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Sampling period, s.
const PERIOD: f64 = 0.006;
/// Samples of a recording.
const SAMPLES: u32 = 2000;
/// Steps between two samples.
const STEPS: u32 = 120;
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

/// Step of the integration, s.
const STEP: f64 = PERIOD / STEPS as f64;

/// Position of the motor side: the moves of the other tests, then the same backwards, so that what is learned in
/// some of them can be judged in others.
fn moved(t: f64) -> f64 {
    position(t) - position(t - 6.0)
}

/// Motor side and link of a joint with a spring, over the deformation, and a friction, over the link's speed, each over the
/// stiffness, by Euler's symplectic rule.
fn motion(spring: impl Fn(f64) -> f64, friction: impl FnMut(f64) -> f64) -> [Vec<f64>; 2] {
    motion_behind(|u| u, spring, friction)
}

/// The same behind a transmission, which passes on a function of the motor side's position.
fn motion_behind(
    passed_on: impl Fn(f64) -> f64,
    spring: impl Fn(f64) -> f64,
    mut friction: impl FnMut(f64) -> f64,
) -> [Vec<f64>; 2] {
    let [mut y, mut v] = [0.0_f64; 2];
    let mut sides = [Vec::new(), Vec::new()];
    for sample in 0..SAMPLES {
        let at = |step: u32| moved(f64::from(sample * STEPS + step) * STEP);
        let moved = |step: u32| passed_on(at(step));
        sides[0].push(at(0));
        sides[1].push(y);
        for step in 0..STEPS {
            let (u, speed) = (moved(step), (moved(step + 1) - moved(step)) / STEP);
            let held = spring(y - u) + 2.0 * DAMPING_RATIO / FREQUENCY * (v - speed);
            v -= STEP * FREQUENCY.powi(2) * (held + friction(v));
            y += STEP * v;
        }
    }
    sides
}

/// What is said of a joint with these motions, seen by a noisy sensor of its link.
fn said([motor, link]: [Vec<f64>; 2]) -> Diagnosis {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut noisy = |y: f64| -> f64 {
        let white: f64 = StandardNormal.sample(&mut random);
        y + NOISE * white
    };
    let link = link.into_iter().map(&mut noisy).collect();
    let angles = [(Role::MotorPosition, motor), (Role::LinkPosition, link)];
    let stamps: Vec<f64> = (0..SAMPLES)
        .map(|sample| f64::from(sample) * PERIOD)
        .collect();
    let recording = two_angles("untidy", &stamps, angles);
    let model = "kind = \"flexible_joint\"\nnatural_frequency_hz = 9.2\ndamping_ratio = 0.033\n";
    let model = Model::from_toml(model, "model.toml").unwrap();
    let outcome = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {});
    let said = outcome.unwrap().diagnosis;
    println!("{}", said.summary);
    said
}

/// No law alone explains much, and no two of the catalogue leave only noise: both are told none the less. The oil damps in
/// the gap as well, and the link's bearing has bristles (Canudas de Wit et al. 1995).
#[test]
fn a_gap_and_a_friction_are_told_though_neither_has_the_textbooks_shape() {
    let mut bristle = 0.0;
    let friction = |v: f64| {
        bristle += STEP * (v - v.abs() * bristle / BRISTLE);
        FRICTION * bristle / BRISTLE
    };
    let said = said(motion(behind_gap, friction));
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

/// One law, which the catalogue does not have, is told as a curve that leaves little more than noise.
fn is_learned(motion: [Vec<f64>; 2], effect: &str) {
    let said = said(motion);
    let found: Vec<_> = said.findings.iter().map(|own| &own.effect[..]).collect();
    let left = said.fit.after.held_out_over_noise;
    assert!(found == [effect] && left < 1.1, "{found:?}, {left}");
}

/// A spring that gives way about its rest, as that of a strain wave gear does.
#[test]
fn a_spring_that_is_soft_about_its_rest_is_learned() {
    let soft = |x: f64| x * (1.0 - 0.3 * (-(x / 2e-3).powi(2)).exp());
    is_learned(motion(soft, |_| 0.0), "learned_spring");
}

/// Friction that rises within a hundredth of the speeds and falls within a tenth, as simulators write Stribeck's: `F_c tanh(v /
/// v_c) + sqrt(2 e) (F_b - F_c) (v / v_s) exp(-(v / v_s)^2)`.
#[test]
fn a_friction_that_rises_and_falls_about_rest_is_learned() {
    let friction = |v: f64| {
        let slow = v / 0.1;
        let excess = (2.0 * 1.0_f64.exp()).sqrt() * slow * (-slow * slow).exp();
        4.0 * FRICTION * ((v / 0.01).tanh() + 0.5 * excess)
    };
    is_learned(motion(|x| x, friction), "learned_friction");
}

/// An eccentric gear with a bad tooth: an error with harmonics, of which the travel has a period and a half.
#[test]
fn a_transmission_error_with_harmonics_is_learned() {
    let error = |u: f64| {
        let turn = 6.0 * u + 0.5;
        2e-3 * (turn.sin() + 0.5 * (2.0 * turn + 1.0).sin() + 0.3 * (3.0 * turn).sin())
    };
    let motion = motion_behind(|u| u + error(u), |x| x, |_| 0.0);
    is_learned(motion, "learned_transmission_error");
}

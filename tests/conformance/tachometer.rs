//! A motor side whose position was not recorded: noise and offset of a tachometer add up in its integral.

use crate::machines::{PERIOD, position, stamps, two_angles};
use quell::diagnosis::{Diagnosis, Options, Verdict, diagnose};
use quell::model::Model;
use quell::recording::Role;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Steps between two samples.
const STEPS: u32 = 80;
/// Natural frequency in small motion, rad/s.
const FREQUENCY: f64 = 8.4 * TAU;
const DAMPING_RATIO: f64 = 0.04;
/// Noise of the tachometer, rad/s. Over the recording it adds up to 0.8 mrad.
const TACHOMETER: f64 = 5e-3;
/// What it shows at rest, rad/s.
const OFFSET: f64 = 2e-3;
/// Noise of the link's encoder, rad.
const ENCODER: f64 = 5e-5;

/// What is said of the motion of a link on a spring of this cubic part, 1/rad^2, by Euler's symplectic rule.
fn said(cubic: f64, seed: u64) -> Diagnosis {
    let h = PERIOD / f64::from(STEPS);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut white = |deviation: f64| -> f64 {
        let drawn: f64 = StandardNormal.sample(&mut random);
        deviation * drawn
    };
    let [mut y, mut v] = [position(0.0), 0.0];
    let [mut velocity, mut link] = [Vec::new(), Vec::new()];
    for sample in 0..stamps(PERIOD).len() as u32 {
        let at = |step: f64| position((f64::from(sample * STEPS) + step) * h);
        let speed = |step: f64| (at(step + 0.5) - at(step - 0.5)) / h;
        velocity.push(speed(0.0) + OFFSET + white(TACHOMETER));
        link.push(y + white(ENCODER));
        for step in (0..STEPS).map(f64::from) {
            let bent = y - at(step);
            let spring = bent + cubic * bent.powi(3);
            let damper = 2.0 * DAMPING_RATIO / FREQUENCY * (v - speed(step));
            v -= h * FREQUENCY.powi(2) * (spring + damper);
            y += h * v;
        }
    }
    let sides = [(Role::MotorVelocity, velocity), (Role::LinkPosition, link)];
    let mut recording = two_angles("tachometer", &stamps(PERIOD), sides);
    recording.channels[0].unit = "rad/s".into();
    let model = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.05\n";
    let model = Model::from_toml(model, "model.toml").unwrap();
    let said = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {});
    let said = said.unwrap().diagnosis;
    println!("{}", said.summary);
    said
}

#[test]
fn noise_that_adds_up_is_no_missing_physics() {
    for seed in 1..=4 {
        assert_eq!(said(0.0, seed).verdict, Verdict::NoMismatch);
    }
}

#[test]
fn a_spring_is_found_beside_noise_that_adds_up() {
    let (said, truth) = (said(3000.0, 1), 3000.0);
    let names: Vec<&str> = said
        .findings
        .iter()
        .map(|own| own.effect.as_str())
        .collect();
    assert_eq!(names, ["cubic_stiffness"]);
    let found = said.findings[0].parameters[0].value;
    assert!((found / truth - 1.0).abs() < 0.1, "{found} for {truth}");
    let remarks = said.remarks.join("\n");
    assert!(remarks.contains("motor_position"), "{remarks}");
}

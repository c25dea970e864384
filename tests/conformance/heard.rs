//! Noise of what drives the model, which the link is told to hear: of a tachometer whose integral is the motion of the motor
//! side, and of a force that is known.

use crate::machines::{PERIOD, angle, position, stamps, two_angles};
use quell::diagnosis::{Diagnosis, Options, Verdict, diagnose};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// Steps between two samples.
const STEPS: u32 = 80;
/// Natural frequency in small motion, rad/s.
const FREQUENCY: f64 = 8.4 * TAU;
const DAMPING_RATIO: f64 = 0.04;
/// Inertia of the link, kg m^2.
const INERTIA: f64 = 0.5;
/// Noise of the tachometer, rad/s. Over the recording it adds up to 0.8 mrad.
const TACHOMETER: f64 = 5e-3;
/// What it shows at rest, rad/s.
const OFFSET: f64 = 2e-3;
/// Noise of the force, N.m. Behind the mode it is ten times that of the encoder.
const FORCE: f64 = 0.5;
/// Noise of the link's encoder, rad.
const ENCODER: f64 = 5e-5;

/// White noise.
struct White(ChaCha8Rng);

impl White {
    fn of(&mut self, deviation: f64) -> f64 {
        let drawn: f64 = StandardNormal.sample(&mut self.0);
        deviation * drawn
    }
}

/// Speed of the motor side, by differences.
fn speed(t: f64) -> f64 {
    let h = 0.5 * PERIOD / f64::from(STEPS);
    (position(t + h) - position(t - h)) / (2.0 * h)
}

/// A link on a spring of this cubic part, 1/rad^2, with a force on it, N.m, by Euler's symplectic rule.
fn link(cubic: f64, force: fn(f64) -> f64) -> Vec<f64> {
    let h = PERIOD / f64::from(STEPS);
    let bent = force(0.0) / INERTIA / FREQUENCY.powi(2);
    let [mut y, mut v] = [position(0.0) + bent, 0.0];
    let mut link = Vec::new();
    for sample in 0..stamps(PERIOD).len() as u32 {
        link.push(y);
        for step in 0..STEPS {
            let t = f64::from(sample * STEPS + step) * h;
            let bent = y - position(t);
            let spring = bent + cubic * bent.powi(3);
            let damper = 2.0 * DAMPING_RATIO / FREQUENCY * (v - speed(t));
            v += h * (force(t) / INERTIA - FREQUENCY.powi(2) * (spring + damper));
            y += h * v;
        }
    }
    link
}

fn said(recording: Recording) -> Diagnosis {
    let model = format!(
        "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.05\nlink_inertia = {INERTIA}\n"
    );
    let model = Model::from_toml(&model, "model.toml").unwrap();
    let said = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {});
    let said = said.unwrap().diagnosis;
    println!("{}", said.summary);
    said
}

/// The noisy encoder of the link.
fn encoder(white: &mut White, cubic: f64, force: fn(f64) -> f64) -> Vec<f64> {
    let values = link(cubic, force).into_iter();
    values.map(|y| y + white.of(ENCODER)).collect()
}

fn behind_a_tachometer(cubic: f64, seed: u64) -> Recording {
    let mut white = White(ChaCha8Rng::seed_from_u64(seed));
    let values = encoder(&mut white, cubic, |_| 0.0);
    let time = stamps(PERIOD);
    let shown = time
        .iter()
        .map(|t| speed(*t) + OFFSET + white.of(TACHOMETER));
    let sides = [
        (Role::MotorVelocity, shown.collect()),
        (Role::LinkPosition, values),
    ];
    let mut recording = two_angles("tachometer", &time, sides);
    recording.channels[0].unit = "rad/s".into();
    recording
}

fn under_a_force(cubic: f64, seed: u64) -> Recording {
    let force = |t: f64| 2.0 * (3.1 * t).sin() + 1.3 * (1.7 * t + 0.4).cos();
    let mut white = White(ChaCha8Rng::seed_from_u64(seed));
    let values = encoder(&mut white, cubic, force);
    let time = stamps(PERIOD);
    let measured = time.iter().map(|t| force(*t) + white.of(FORCE)).collect();
    let sides = [
        (
            Role::MotorPosition,
            time.iter().map(|t| position(*t)).collect(),
        ),
        (Role::LinkPosition, values),
    ];
    let mut recording = two_angles("force", &time, sides);
    recording.channels.push(Channel {
        unit: "N.m".into(),
        columns: vec![measured],
        ..angle(Role::KnownForce, &time, |_| 0.0)
    });
    recording
}

#[test]
fn noise_that_is_heard_is_no_missing_physics() {
    for seed in 1..=4 {
        for recording in [behind_a_tachometer, under_a_force].map(|of| of(0.0, seed)) {
            assert_eq!(said(recording).verdict, Verdict::NoMismatch);
        }
    }
}

#[test]
fn a_spring_is_found_beside_noise_that_is_heard() {
    let truth = 3000.0;
    for recording in [behind_a_tachometer, under_a_force].map(|of| of(truth, 1)) {
        let integrated = recording.channels[0].role == Role::MotorVelocity;
        let said = said(recording);
        let all = said.findings.iter().map(|own| own.effect.as_str());
        assert_eq!(all.collect::<Vec<_>>(), ["cubic_stiffness"]);
        let found = said.findings[0].parameters[0].value;
        assert!((found / truth - 1.0).abs() < 0.1, "{found} for {truth}");
        let is_told = said.remarks.join("\n").contains("record motor_position");
        assert_eq!(is_told, integrated, "{:?}", said.remarks);
    }
}

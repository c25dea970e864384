//! Whether the intervals of a diagnosis hold the truth as often as they say.

use quell::diagnosis::{Options, Verdict, diagnose};
use quell::effects::{Effect, Place};
use quell::model::{Departure, Experiment, Model, Term, simulate};
use quell::recording::{Channel, Recording, Role};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;

const CASES: u64 = 40;
const SECONDS: f64 = 4.5;
/// Noise of the link's sensor, and step of the encoder, rad: what a joint of 8 Hz makes of the encoder's
/// rounding at its resonance is as large as what the sensor's noise leaves of it.
const NOISE: f64 = 1e-5;
const STEP: f64 = 1e-5;
const MODEL: &str =
    "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.1\ndamping_ratio = 0.055\n";

/// Position, velocity and acceleration vanish at both ends but for the travel.
fn smooth(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s.powi(4) * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s)))
}

/// Moves there and back, of other lengths in each case.
fn motion(random: &mut ChaCha8Rng) -> impl Fn(f64) -> f64 + use<> {
    let moves: Vec<[f64; 3]> = (0..6)
        .map(|k| {
            let start = 0.3 + 0.68 * f64::from(k) + random.random_range(0.0..0.05);
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let travel = sign * random.random_range(0.15..0.3);
            [start, random.random_range(0.25..0.4), travel]
        })
        .collect();
    move |t| {
        let parts = moves.iter();
        parts
            .map(|[start, length, travel]| travel * smooth((t - start) / length))
            .sum()
    }
}

fn recording(motor: Vec<f64>, link: Vec<f64>, time: &[Vec<f64>; 2]) -> Recording {
    let channel = |role, values, time: &Vec<f64>| Channel {
        role,
        unit: "rad".into(),
        time: time.clone(),
        columns: vec![values],
    };
    Recording {
        payload: None,
        name: "moves".into(),
        channels: vec![
            channel(Role::MotorPosition, motor, &time[0]),
            channel(Role::LinkPosition, link, &time[1]),
        ],
    }
}

/// A joint with a hardening spring, its motor side rounded, its link in noise; and the true `k3`.
fn case(seed: u64) -> (Recording, f64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let at = motion(&mut random);
    let stamps = |rate: f64| -> Vec<f64> {
        let count = (SECONDS * rate) as usize;
        (0..count).map(|k| k as f64 / rate).collect()
    };
    let time = [stamps(250.0), stamps(200.0)];
    let exact: Vec<f64> = time[0].iter().map(|&t| at(t)).collect();
    let still = vec![0.0; time[1].len()];
    let mut model = Model::from_toml(MODEL, "model.toml").unwrap();
    model.values[0].value = 8.0;
    model.values[1].value = 0.05;
    let experiment = Experiment::new(&model, &recording(exact.clone(), still, &time)).unwrap();
    let k3 = random.random_range(0.5e4..1.5e4);
    let hardening = Term::new(
        Effect::from_name("cubic_stiffness").unwrap(),
        Place::Transmission,
        vec![k3],
    );
    let motion = simulate(
        model.kind,
        &model.keys(),
        &[hardening],
        &experiment,
        &Departure::default(),
    );
    let seen = motion.predict(&experiment.outputs[0], 0.0).values;
    let noisy = seen
        .iter()
        .map(|y| y + NOISE * random.sample::<f64, _>(StandardNormal))
        .collect();
    let phase: f64 = random.random();
    let rounded = exact
        .iter()
        .map(|u| STEP * ((u / STEP + phase).round() - phase))
        .collect();
    (recording(rounded, noisy, &time), k3)
}

/// Of 40 intervals of 95 %, at least 34 hold the truth (fewer by chance: 1 in 300); and the errors are as
/// large as the intervals say within three standard deviations of an rms of 40, `3 / sqrt 80 = 1/3`.
#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    let model = Model::from_toml(MODEL, "model.toml").unwrap();
    let one = |seed| {
        let (recording, k3) = case(seed);
        let options = Options {
            seed,
            ..Options::default()
        };
        let train = std::slice::from_ref(&recording);
        let outcome = diagnose(&model, train, &[], &options, &|_, _| {}).unwrap();
        let findings = &outcome.diagnosis.findings;
        let [finding] = &findings[..] else {
            panic!("case {seed}: {}", outcome.diagnosis.summary);
        };
        assert_eq!(finding.effect, "cubic_stiffness", "case {seed}");
        let [low, high] = finding.parameters[0].ci95;
        // In standard deviations that the interval says.
        1.96 * (finding.parameters[0].value - k3) / (0.5 * (high - low))
    };
    let errors: Vec<f64> = (0..CASES).into_par_iter().map(one).collect();
    let held = errors.iter().filter(|error| error.abs() <= 1.96).count();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / CASES as f64).sqrt();
    println!("{held} of {CASES} hold the truth; rms error {rms:.2} standard deviations");
    assert!(held >= 34, "{held}: {errors:.2?}");
    assert!((rms - 1.0).abs() < 1.0 / 3.0, "{rms}: {errors:.2?}");
}

/// A wrong size of an effect that the model has is fitted, as its keys are, and is no new physics; where
/// it is fixed, something is missing.
#[test]
fn effects_of_the_model_are_refitted() {
    let (recording, k3) = case(1);
    let verdict = |fixed: bool| {
        let effect = format!(
            "[[effect]]\nname = \"cubic_stiffness\"\n[effect.parameters]\n\
             k3 = {{ value = {:?}, fixed = {fixed} }}\n",
            0.3 * k3
        );
        let model = Model::from_toml(&format!("{MODEL}{effect}"), "model.toml").unwrap();
        let train = std::slice::from_ref(&recording);
        let outcome = diagnose(&model, train, &[], &Options::default(), &|_, _| {}).unwrap();
        let fitted = outcome.model.effects[0].parameters[0].value;
        (outcome.diagnosis.verdict, fitted)
    };
    let (free, fitted) = verdict(false);
    assert_eq!(free, Verdict::NoMismatch);
    assert!((fitted / k3 - 1.0).abs() < 0.05, "{fitted} of {k3}");
    let (fixed, kept) = verdict(true);
    assert_ne!(fixed, Verdict::NoMismatch);
    assert_eq!(kept, 0.3 * k3);
}

//! What a diagnosis says where what is left is not this joint's.

use quell::diagnosis::{Diagnosis, Options, diagnose};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::TAU;

const RATE: f64 = 200.0;
const SECONDS: f64 = 8.0;
/// Small steps, so that Euler's rule errs by less than the noise.
const STEPS: u32 = 100;
const NOISE: f64 = 1e-5;
const FREQUENCY: f64 = 5.0 * TAU;
const DAMPING: f64 = 0.08;
const MODEL: &str =
    "kind = \"flexible_joint\"\nnatural_frequency_hz = 5.1\ndamping_ratio = 0.075\n";

/// Two moves there and back in the first half, and rest in the second; the base is moved with an acceleration.
fn recording(base: impl Fn(f64) -> f64) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let h = 1.0 / (RATE * f64::from(STEPS));
    let [mut x, mut v, mut u, mut speed] = [0.0_f64; 4];
    let [mut time, mut motor, mut deformation] = [(); 3].map(|()| Vec::new());
    for sample in 0..(SECONDS * RATE) as u32 {
        time.push(f64::from(sample) / RATE);
        motor.push(u);
        deformation.push(x + NOISE * random.sample::<f64, _>(StandardNormal));
        for step in 0..STEPS {
            let time = f64::from(sample * STEPS + step) * h;
            let pulse = |(start, length, size): (f64, f64, f64)| {
                let phase = (time - start) / length;
                let within = (0.0..1.0).contains(&phase);
                if within {
                    5.0 * size * (TAU * phase).sin()
                } else {
                    0.0
                }
            };
            let moves = [
                (0.3, 0.35, 1.0),
                (1.2, 0.3, -1.0),
                (2.1, 0.4, 1.0),
                (3.0, 0.5, -0.7),
            ];
            let input: f64 = moves.map(pulse).iter().sum();
            let force = -FREQUENCY * FREQUENCY * x - 2.0 * DAMPING * FREQUENCY * v;
            v += h * (force - input - base(time));
            x += h * v;
            speed += h * input;
            u += h * speed;
        }
    }
    let channel = |role, values| Channel {
        role,
        unit: "rad".into(),
        time: time.clone(),
        columns: vec![values],
    };
    Recording {
        payload: None,
        name: "moves".into(),
        channels: vec![
            channel(Role::MotorPosition, motor),
            channel(Role::Deformation, deformation),
        ],
    }
}

fn diagnosis(base: impl Fn(f64) -> f64) -> Diagnosis {
    let model = Model::from_toml(MODEL, "model.toml").unwrap();
    let recording = recording(base);
    let train = std::slice::from_ref(&recording);
    let options = Options::default();
    let outcome = diagnose(&model, train, &[], &options, &|_, _| {}).unwrap();
    outcome.diagnosis
}

fn says(diagnosis: &Diagnosis, words: &str) -> bool {
    diagnosis
        .remarks
        .iter()
        .any(|remark| remark.contains(words))
}

/// Another joint that starts and stops while this one rests moves what both stand on.
#[test]
fn motion_at_rest_comes_from_elsewhere() {
    let other = |time: f64| {
        let phase = (0.9 * time * time).sin() + (2.3 * time).cos();
        if time > 4.5 { 0.4 * phase.powi(3) } else { 0.0 }
    };
    let told = diagnosis(other);
    assert!(says(&told, "While the input rests"), "{told:#?}");
    let own = diagnosis(|_| 0.0);
    assert!(!says(&own, "While the input rests"), "{own:#?}");
}

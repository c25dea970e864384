//! What a diagnosis says where what is left is not this joint's.

#[path = "small/motion.rs"]
mod motion;

use motion::Joint;
use quell::diagnosis::{Diagnosis, Options, Verdict, diagnose};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::TAU;

const JOINT: Joint = Joint {
    frequency: 5.0 * TAU,
    damping: 0.08,
    rate: 200.0,
    samples: 1600,
    acceleration: 5.0,
};
const NOISE: f64 = 1e-5;
const MODEL: &str =
    "kind = \"flexible_joint\"\nnatural_frequency_hz = 5.1\ndamping_ratio = 0.075\n";

/// Two moves there and back in the first half of eight seconds, and rest in the second: time, motor position and deformation in
/// noise.
fn moves(base: impl Fn(f64) -> f64) -> [Vec<f64>; 3] {
    moves_of(&JOINT, base)
}

fn moves_of(joint: &Joint, base: impl Fn(f64) -> f64) -> [Vec<f64>; 3] {
    let moves = [
        (0.3, 0.35, 1.0),
        (1.2, 0.3, -1.0),
        (2.1, 0.4, 1.0),
        (3.0, 0.5, -0.7),
    ];
    let motion = joint.motion(&moves, base);
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut noisy = |x: f64| x + NOISE * random.sample::<f64, _>(StandardNormal);
    [
        (0..motion.len()).map(|k| k as f64 / joint.rate).collect(),
        motion.iter().map(|sample| sample[0]).collect(),
        motion.iter().map(|sample| noisy(sample[1])).collect(),
    ]
}

fn recording(time: &[f64], channels: [(Role, &str, Vec<f64>); 2]) -> Recording {
    let channel = |(role, unit, values): (Role, &str, Vec<f64>)| Channel {
        role,
        unit: unit.into(),
        time: time.to_vec(),
        columns: vec![values],
    };
    Recording {
        payload: None,
        name: "moves".into(),
        channels: channels.map(channel).into(),
    }
}

fn diagnosed(recording: &Recording) -> Diagnosis {
    diagnosed_by(MODEL, recording)
}

fn diagnosed_by(model: &str, recording: &Recording) -> Diagnosis {
    let model = Model::from_toml(model, "model.toml").unwrap();
    let train = std::slice::from_ref(recording);
    let options = Options::default();
    let outcome = diagnose(&model, train, &[], &options, &|_, _| {}).unwrap();
    outcome.diagnosis
}

/// The joint on a base that is moved with an acceleration.
fn on_base(base: impl Fn(f64) -> f64) -> Diagnosis {
    let [time, motor, deformation] = moves(base);
    let channels = [
        (Role::MotorPosition, "rad", motor),
        (Role::Deformation, "rad", deformation),
    ];
    diagnosed(&recording(&time, channels))
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
    let told = on_base(other);
    assert!(says(&told, "While the input rests"), "{told:#?}");
    let own = on_base(|_| 0.0);
    assert!(!says(&own, "While the input rests"), "{own:#?}");
}

/// Two sensors in raw counts, an encoder or a strain gauge on the link: the gain between them is no physics. It is fitted
/// and told, and nothing is missing, also where the vibration lasts and the model's frequency is not that of it.
#[test]
fn gains_of_raw_counts_are_fitted() {
    let lasting = Joint {
        damping: 0.02,
        ..JOINT
    };
    let off = "kind = \"flexible_joint\"\nnatural_frequency_hz = 5.2\ndamping_ratio = 0.02\n";
    let (of_motor, of_link, of_strain) = (1_048_576.0 / TAU, -262_144.0 / TAU, -40_000.0);
    for (joint, model, role) in [
        (&JOINT, MODEL, Role::LinkPosition),
        (&lasting, off, Role::LinkPosition),
        (&JOINT, MODEL, Role::Deformation),
        (&lasting, off, Role::Deformation),
    ] {
        let [time, motor, deformation] = moves_of(joint, |_| 0.0);
        let link = motor.iter().zip(&deformation).map(|(u, d)| u + d);
        let counts =
            |values: Vec<f64>, gain: f64| values.iter().map(|v| (gain * v).round()).collect();
        let (shown, gain): (Vec<f64>, f64) = match role {
            Role::LinkPosition => (counts(link.collect(), of_link), of_link),
            _ => (counts(deformation, of_strain), of_strain),
        };
        let channels = [
            (Role::MotorPosition, "count", counts(motor, of_motor)),
            (role, "raw", shown),
        ];
        let told = diagnosed_by(model, &recording(&time, channels));
        assert_eq!(told.verdict, Verdict::NoMismatch, "{told:#?}");
        let remark = told
            .remarks
            .iter()
            .find(|own| own.contains(&format!("scale of {role}")));
        let remark = remark.expect("a remark on the gain");
        let words: Vec<f64> = remark
            .split(' ')
            .filter_map(|word| word.parse().ok())
            .collect();
        assert!(
            (words[0] / (gain / of_motor) - 1.0).abs() < 2e-3,
            "{remark}"
        );
    }
}

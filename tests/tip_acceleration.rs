//! An accelerometer at the tip, whose axes may be mounted at any angle.

use quell::diagnosis::{Options, Verdict, diagnose};
use quell::model::{Departure, Experiment, ExperimentError, Model, Output, simulate};
use quell::recording::{Channel, Recording, Role};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::slice::from_ref;

const ARM: f64 = 0.5;
const NOISE: f64 = 2e-2;

fn joint(frequency: f64) -> Model {
    let text = format!(
        "kind = \"flexible_joint\"\nnatural_frequency_hz = {frequency}\ndamping_ratio = 0.03\nlever_arm_m = {ARM}\n"
    );
    Model::from_toml(&text, "model.toml").unwrap()
}

/// A recording of a motor position and columns of the tip's acceleration.
fn recording(motor: &[f64], columns: Vec<Vec<f64>>) -> Recording {
    let time: Vec<f64> = (0..motor.len()).map(|k| k as f64 * 2e-3).collect();
    let channel = |role, unit: &str, columns| Channel {
        role,
        unit: unit.into(),
        time: time.clone(),
        columns,
    };
    Recording {
        payload: None,
        name: "moves".into(),
        channels: vec![
            channel(Role::MotorPosition, "rad", vec![motor.to_vec()]),
            channel(Role::TipAcceleration, "m/s^2", columns),
        ],
    }
}

/// Smooth moves of a radian, there and back.
fn motor() -> Vec<f64> {
    let step = |t: f64| {
        let s = (t / 0.35).clamp(0.0, 1.0);
        s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)
    };
    let at = |t: f64| step(t - 0.3) - step(t - 1.5) + step(t - 2.6) - step(t - 3.5);
    (0..2400).map(|k| at(f64::from(k) * 2e-3)).collect()
}

/// Accelerations along the tip's motion and towards the centre of its circle, m/s^2.
fn accelerations(truth: &Model) -> [Vec<f64>; 2] {
    let zeros = vec![0.0; motor().len()];
    let experiment = Experiment::new(truth, &recording(&motor(), vec![zeros])).unwrap();
    let keys = truth.keys();
    let simulated = simulate(truth.kind, &keys, &[], &experiment, &Departure::default());
    let read = |role| {
        let output = Output {
            role,
            ..experiment.outputs[0].clone()
        };
        simulated.predict(&output, 0.0).values
    };
    let along = read(Role::LinkAcceleration)
        .iter()
        .map(|a| ARM * a)
        .collect();
    let rates = read(Role::LinkVelocity);
    [along, rates.iter().map(|v| -ARM * v * v).collect()]
}

/// One column along the tip's motion and three columns of a turned sensor give the same diagnosis.
#[test]
fn columns_of_a_turned_sensor_are_read_along_the_motion() {
    let [along, across] = accelerations(&joint(8.0));
    let (mut random, normal) = (
        ChaCha8Rng::seed_from_u64(3),
        Normal::new(0.0, NOISE).unwrap(),
    );
    let mut column = |[tangential, radial, offset]: [f64; 3]| -> Vec<f64> {
        let pairs = along.iter().zip(&across);
        let values = pairs.map(|(t, r)| tangential * t + radial * r + offset);
        values
            .map(|value| value + normal.sample(&mut random))
            .collect()
    };
    // The first axis sees mostly what acts across.
    let (sin, cos) = 1.1f64.sin_cos();
    let (up, level) = 0.3f64.sin_cos();
    let turned = [
        [cos * level, -sin * level, 0.2],
        [sin, cos, -0.1],
        [cos * up, -sin * up, 9.81],
    ];
    let one = recording(&motor(), vec![column([1.0, 0.0, 0.0])]);
    let three = recording(&motor(), turned.map(&mut column).to_vec());
    let model = joint(8.6);
    let direction = &Experiment::new(&model, &three).unwrap().outputs[0].direction;
    for (own, [right, ..]) in direction.iter().zip(turned) {
        assert!((own - right).abs() < 5e-3, "{direction:?}");
    }
    let of = |own: &Recording| {
        let outcome = diagnose(&model, from_ref(own), &[], &Options::default(), &|_, _| {});
        outcome.unwrap().diagnosis
    };
    let [one, three] = [&one, &three].map(of);
    assert_eq!(one.verdict, Verdict::NoMismatch, "{}", one.summary);
    assert_eq!(three.verdict, Verdict::NoMismatch, "{}", three.summary);
    let frequency = three.nuisances["natural_frequency_hz"];
    assert!((frequency - 8.0).abs() < 8e-3, "{frequency}");
    for (key, truth) in [("natural_frequency_hz", 8.0), ("damping_ratio", 0.03)] {
        let [from, to] = three.nuisances_ci95[key];
        // Twice as wide, so that one in twenty is no failure.
        let spare = 0.5 * (to - from);
        assert!(
            from - spare < truth && truth < to + spare,
            "{key}: {from} to {to}"
        );
        assert!(from < three.nuisances[key] && three.nuisances[key] < to);
    }
    let told = |own: &String| {
        own.contains("tip_acceleration") && own.contains("the direction of the tip's motion")
    };
    assert!(three.remarks.iter().any(told) && !one.remarks.iter().any(told));
}

#[test]
fn columns_without_motion_are_refused() {
    let (mut random, normal) = (
        ChaCha8Rng::seed_from_u64(4),
        Normal::new(0.0, NOISE).unwrap(),
    );
    let still = [0, 1, 2].map(|_| (0..2400).map(|_| normal.sample(&mut random)).collect());
    let motor: Vec<f64> = (0..2400).map(|k| 1e-6 * f64::from(k % 2)).collect();
    let error = Experiment::new(&joint(8.0), &recording(&motor, still.to_vec())).unwrap_err();
    assert!(
        matches!(error, ExperimentError::NoTangent { columns: 3, .. }),
        "{error}"
    );
    assert!(
        error.to_string().contains("tip_acceleration of \"")
            && error.to_string().contains("has 3 columns"),
        "{error}"
    );
}

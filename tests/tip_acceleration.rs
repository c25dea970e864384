//! An accelerometer at the tip, whose axes may be mounted at any angle.

use quell::diagnosis::{Options, Verdict, diagnose};
use quell::model::{Departure, Experiment, ExperimentError, Model, Output, simulate};
use quell::recording::{Channel, Recording, Role};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
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

/// Samples of the sensor's noise.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, NOISE).unwrap();
    move || normal.sample(&mut random)
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
    let mut noise = noise(3);
    let mut column = |[tangential, radial, offset]: [f64; 3]| -> Vec<f64> {
        let pairs = along.iter().zip(&across);
        let values = pairs.map(|(t, r)| tangential * t + radial * r + offset);
        values.map(|value| value + noise()).collect()
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
    let mut noise = noise(4);
    let still = [0, 1, 2].map(|_| (0..2400).map(|_| noise()).collect());
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

/// Acceleration of a link of 8 Hz that half a sine of force knocks at a time, in steps of 20 us.
fn knocked(time: f64, duration: f64, jump: f64) -> Vec<f64> {
    const STEPS: usize = 100;
    let w = 8.0 * TAU;
    let (mut x, mut v) = (0.0, 0.0);
    let acceleration = |k: usize| {
        let mut a = 0.0;
        for step in 0..STEPS {
            let t = (k * STEPS + step) as f64 * 2e-3 / STEPS as f64;
            let turn = PI * (t - time) / duration;
            let push = if turn.abs() < FRAC_PI_2 {
                turn.cos()
            } else {
                0.0
            };
            let now = jump * FRAC_PI_2 / duration * push - 2.0 * 0.03 * w * v - w * w * x;
            v += now * 2e-3 / STEPS as f64;
            x += v * 2e-3 / STEPS as f64;
            a = if step == 0 { now } else { a };
        }
        a
    };
    (0..2400).map(acceleration).collect()
}

/// An accelerometer shows how long a knock lasts: both are told with what they were, within what half a sine and a parabola
/// differ by.
#[test]
fn two_knocks_have_their_durations() {
    let [along, _] = accelerations(&joint(8.0));
    let mut noise = noise(5);
    let knocks = [(1.2, 0.03, 0.02), (3.2, 0.012, -0.01)];
    let all = knocks.map(|(time, duration, jump)| knocked(time, duration, jump));
    let mut with = |share: f64| {
        let value = |k: usize| along[k] + share * ARM * (all[0][k] + all[1][k]);
        let noisy = (0..2400).map(|k| value(k) + noise());
        recording(&motor(), vec![noisy.collect()])
    };
    let (own, apart) = (with(1.0), with(0.0));
    let outcome = diagnose(
        &joint(8.2),
        &[own],
        &[apart],
        &Options::default(),
        &|_, _| {},
    );
    let said = outcome.unwrap().diagnosis;
    let [finding] = &said.findings[..] else {
        panic!("{}", said.summary);
    };
    assert_eq!(finding.effect, "external_disturbance", "{}", said.summary);
    let told = |name: &str| {
        let own = finding.parameters.iter();
        let own = own.filter(|own| own.name.starts_with(name));
        own.map(|own| own.value).collect::<Vec<f64>>()
    };
    let mut found: Vec<(f64, f64, f64)> = told("time")
        .into_iter()
        .zip(told("duration").into_iter().zip(told("jump")))
        .map(|(time, (duration, jump))| (time, duration, jump))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(found.len(), 2, "{}", said.summary);
    for (found, knock) in found.iter().zip(knocks) {
        assert!((found.0 - knock.0).abs() < 5e-4, "{found:?} for {knock:?}");
        assert!(
            (found.1 / knock.1 - 1.0).abs() < 0.1,
            "{found:?} for {knock:?}"
        );
        assert!(
            (found.2 / knock.2 - 1.0).abs() < 0.05,
            "{found:?} for {knock:?}"
        );
    }
}

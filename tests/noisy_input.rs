//! Joints whose motor encoder has an error that the joint carries on: a mode makes noise seventeen times as loud at its own
//! frequency, and behind a damper an accelerometer shows the steps of an encoder. Simulated by this file alone.

mod cycloids;

use cycloids::cycloids;
use quell::diagnosis::{Diagnosis, Options, Verdict, diagnose};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::TAU;

const RATE: f64 = 500.0;
/// Standard deviation of the noise of both encoders, rad.
const NOISE: f64 = 5e-5;
/// Step of an encoder, rad.
const STEP: f64 = 2e-5;

/// Start, duration and length of a move.
type Move = (f64, f64, f64);
/// Moves with rest after each.
const MOVES: [Move; 3] = [(1.0, 0.4, 0.6), (4.0, 0.35, -0.8), (7.0, 0.5, 1.1)];
/// Moves with hardly any rest.
const LONG_MOVES: [Move; 5] = [
    (1.0, 0.4, 0.6),
    (1.5, 2.3, 1.0),
    (4.0, 0.35, -0.8),
    (4.5, 2.3, 1.2),
    (7.0, 2.9, -1.5),
];

/// Frequency, Hz, and damping ratio.
const MODE: [f64; 2] = [6.4, 0.03];

/// Position and acceleration of the link behind a mode, ten times as densely sampled as it is recorded.
fn link(moves: &[Move], [f, xi]: [f64; 2]) -> Vec<[f64; 2]> {
    let w = TAU * f;
    let rates = |t: f64, [q, v]: [f64; 2]| {
        let [position, velocity] = cycloids(moves, t);
        [v, w * w * (position - q) + 2.0 * xi * w * (velocity - v)]
    };
    let h = 0.1 / RATE;
    let (mut x, mut all) = ([0.0; 2], Vec::new());
    for k in 0..(100.0 * RATE) as usize {
        // Heun's method.
        let t = k as f64 * h;
        let first = rates(t, x);
        all.push([x[0], first[1]]);
        let ahead = std::array::from_fn(|i| x[i] + h * first[i]);
        let second = rates(t + h, ahead);
        x = std::array::from_fn(|i| x[i] + 0.5 * h * (first[i] + second[i]));
    }
    all
}

/// Diagnosis of a recording of a motor side and a sensor of the link, by a model that believes another mode.
fn diagnosed(
    motor: Vec<f64>,
    (role, unit, link): (Role, &str, Vec<f64>),
    [f, xi]: [f64; 2],
) -> Diagnosis {
    let time: Vec<f64> = (0..motor.len()).map(|k| k as f64 / RATE).collect();
    let channel = |role, unit: &str, values| Channel {
        role,
        unit: unit.into(),
        time: time.clone(),
        columns: vec![values],
    };
    let recording = Recording {
        payload: None,
        name: "moves".into(),
        channels: vec![
            channel(Role::MotorPosition, "rad", motor),
            channel(role, unit, link),
        ],
    };
    let model = format!(
        "kind = \"flexible_joint\"\nnatural_frequency_hz = {}\ndamping_ratio = {xi}\n",
        1.016 * f
    );
    let model = Model::from_toml(&model, "model.toml").unwrap();
    let told = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {});
    told.unwrap().diagnosis
}

/// The motor side as a perfect encoder shows it.
fn motor_positions(moves: &[Move]) -> Vec<f64> {
    let stamps = (0..(10.0 * RATE) as usize).map(|k| k as f64 / RATE);
    stamps.map(|t| cycloids(moves, t)[0]).collect()
}

/// The steps of an encoder.
fn steps(value: f64) -> f64 {
    (value / STEP).round() * STEP
}

/// Two noisy encoders, that of the link late by so many tenths of a sample.
fn two_encoders(late: usize, seed: u64) -> Diagnosis {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noisy = |value: f64| value + NOISE * random.sample::<f64, _>(StandardNormal);
    let truth = link(&MOVES, MODE);
    let at = |k: usize| truth[(10 * k).saturating_sub(late)][0];
    let link = (0..truth.len() / 10).map(|k| noisy(at(k))).collect();
    let motor = motor_positions(&MOVES)
        .into_iter()
        .map(&mut noisy)
        .collect();
    diagnosed(motor, (Role::LinkPosition, "rad", link), MODE)
}

/// The steps of an encoder, as an accelerometer behind the damper of the joint would show them, are no acceleration: a lag of the
/// sensor was told, and a clock offset that cancelled it.
#[test]
fn the_steps_of_an_encoder_are_no_acceleration() {
    let mode = [9.0, 0.08];
    let motor = motor_positions(&MOVES).into_iter().map(steps).collect();
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let mut noisy = |[_, a]: &[f64; 2]| a + 0.04 * random.sample::<f64, _>(StandardNormal);
    let link = link(&MOVES, mode)
        .iter()
        .step_by(10)
        .map(&mut noisy)
        .collect();
    let told = diagnosed(motor, (Role::LinkAcceleration, "rad/s^2", link), mode);
    assert_eq!(told.verdict, Verdict::NoMismatch, "{}", told.summary);
    let damping = told.nuisances["damping_ratio"];
    assert!((damping / mode[1] - 1.0).abs() < 0.05, "{damping}");
}

/// What the mode makes of the input's noise is no missing physics, nor is where it starts.
#[test]
fn the_noise_of_the_input_is_noise() {
    for seed in [1, 2] {
        let told = two_encoders(0, seed);
        assert_eq!(told.verdict, Verdict::NoMismatch, "{}", told.summary);
        let left = told.fit.before.held_out_over_noise;
        assert!((left - 1.0).abs() < 0.25, "{left}");
    }
}

/// The steps of an encoder in motion are noise, which a mode of little damping makes louder: a payload was told, and a frequency
/// that changes with the pose.
#[test]
fn the_steps_of_an_encoder_in_motion_are_noise() {
    let mode = [6.4, 0.01];
    let motor: Vec<f64> = motor_positions(&LONG_MOVES)
        .into_iter()
        .map(steps)
        .collect();
    for seed in [5, 6] {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut noisy =
            |[q, _]: &[f64; 2]| q + 0.2 * STEP * random.sample::<f64, _>(StandardNormal);
        let truth = link(&LONG_MOVES, mode);
        let link = truth.iter().step_by(10).map(&mut noisy).collect();
        let told = diagnosed(motor.clone(), (Role::LinkPosition, "rad", link), mode);
        assert_eq!(told.verdict, Verdict::NoMismatch, "{}", told.summary);
        let left = told.fit.before.held_out_over_noise;
        assert!((left - 1.0).abs() < 0.25, "{left}");
    }
}

/// A delay of the link's encoder is told alone: it was told with a disturbance that stood for the noise.
#[test]
fn a_delay_behind_a_noisy_input_is_told_alone() {
    let told = two_encoders(40, 3);
    let [delay] = &told.findings[..] else {
        panic!("{}", told.summary);
    };
    assert_eq!(delay.effect, "sensor_delay");
    let value = delay.parameters[0].value;
    assert!((value - 0.008).abs() < 2e-5, "{value}");
    assert!(
        told.fit.after.held_out_over_noise < 1.25,
        "{}",
        told.summary
    );
}

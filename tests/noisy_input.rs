//! Joints whose motor encoder is as noisy as the link's: the mode makes the noise of the input seventeen times as loud at its own
//! frequency. Simulated by this file alone.

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

/// Position and velocity of moves with rest after each.
fn motor(t: f64) -> [f64; 2] {
    let all = [(1.0, 0.4, 0.6), (4.0, 0.35, -0.8), (7.0, 0.5, 1.1)];
    cycloids(&all, t)
}

/// The link behind a mode of 6.4 Hz and damping ratio 0.03, ten times as densely sampled as it is recorded.
fn link() -> Vec<f64> {
    let (w, xi) = (TAU * 6.4, 0.03);
    let rates = |t: f64, [q, v]: [f64; 2]| {
        let [position, velocity] = motor(t);
        [v, w * w * (position - q) + 2.0 * xi * w * (velocity - v)]
    };
    let h = 0.1 / RATE;
    let (mut x, mut all) = ([0.0; 2], Vec::new());
    for k in 0..(100.0 * RATE) as usize {
        all.push(x[0]);
        // Heun's method.
        let t = k as f64 * h;
        let first = rates(t, x);
        let ahead = std::array::from_fn(|i| x[i] + h * first[i]);
        let second = rates(t + h, ahead);
        x = std::array::from_fn(|i| x[i] + 0.5 * h * (first[i] + second[i]));
    }
    all
}

/// Diagnosis of a recording whose link encoder is late by so many tenths of a sample.
fn diagnosed(late: usize, seed: u64) -> Diagnosis {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut noisy = |value: f64| value + NOISE * random.sample::<f64, _>(StandardNormal);
    let truth = link();
    let time: Vec<f64> = (0..truth.len() / 10).map(|k| k as f64 / RATE).collect();
    let at = |k: usize| truth[(10 * k).saturating_sub(late)];
    let link = (0..time.len()).map(|k| noisy(at(k))).collect();
    let motor = time.iter().map(|&t| noisy(motor(t)[0])).collect();
    let channel = |role, values| Channel {
        role,
        unit: "rad".into(),
        time: time.clone(),
        columns: vec![values],
    };
    let recording = Recording {
        payload: None,
        name: "moves".into(),
        channels: vec![
            channel(Role::MotorPosition, motor),
            channel(Role::LinkPosition, link),
        ],
    };
    let model = "kind = \"flexible_joint\"\nnatural_frequency_hz = 6.5\ndamping_ratio = 0.03\n";
    let model = Model::from_toml(model, "model.toml").unwrap();
    let told = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {});
    told.unwrap().diagnosis
}

/// What the mode makes of the input's noise is no missing physics, nor is where it starts.
#[test]
fn the_noise_of_the_input_is_noise() {
    for seed in [1, 2] {
        let told = diagnosed(0, seed);
        assert_eq!(told.verdict, Verdict::NoMismatch, "{}", told.summary);
        let left = told.fit.before.held_out_over_noise;
        assert!((left - 1.0).abs() < 0.25, "{left}");
    }
}

/// A delay of the link's encoder is told alone: it was told with a disturbance that stood for the noise.
#[test]
fn a_delay_behind_a_noisy_input_is_told_alone() {
    let told = diagnosed(40, 3);
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

//! What lasts for milliseconds or acts over micrometres: knocks, a stop that is hardly touched, bristles. Simulated by this file
//! alone, and seen by a sensor of positions.

use quell::diagnosis::{Diagnosis, Options, Verdict, diagnose};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::f64::consts::{PI, TAU};

const PERIOD: f64 = 2e-3;
const SAMPLES: usize = 5000;
const FREQUENCY: f64 = 6.0 * TAU;
const DAMPING: f64 = 0.03;

/// Position and velocity of the motor side: moves of many sizes, there and back.
fn motor(t: f64) -> [f64; 2] {
    let moves = [
        (0.3, 0.9, 0.5),
        (1.7, -0.7, 0.3),
        (2.9, 0.5, 0.25),
        (4.2, 0.3, 0.4),
        (5.4, -1.0, 0.45),
        (6.8, 0.8, 0.3),
        (8.1, -0.5, 0.35),
    ];
    let each = moves.map(|(start, size, duration)| {
        let s = ((t - start) / duration).clamp(0.0, 1.0);
        let rate = 140.0 * s.powi(3) * (1.0 - s).powi(3) / duration;
        let value = s.powi(4) * (35.0 - 84.0 * s + 70.0 * s * s - 20.0 * s.powi(3));
        [size * value, size * rate]
    });
    [0, 1].map(|k| each.iter().map(|own| own[k]).sum())
}

/// A link behind a spring, with a force per inertia on it of time, link, deformation and a state with its rate.
fn recorded(
    noise: f64,
    law: impl Fn(f64, [f64; 2], [f64; 2], f64) -> [f64; 2],
) -> (Model, Recording) {
    const STEPS: usize = 100;
    let rates = |t: f64, [y, v, z]: [f64; 3]| {
        let [u, rate] = motor(t);
        let (d, slip) = (y - u, v - rate);
        let [force, own] = law(t, [y, v], [d, slip], z);
        let elastic = FREQUENCY * FREQUENCY * d + 2.0 * DAMPING * FREQUENCY * slip;
        [v, force - elastic, own]
    };
    let normal = Normal::new(0.0, noise).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let (mut state, mut seen) = ([0.0; 3], Vec::new());
    for k in 0..SAMPLES {
        seen.push(state[0] + normal.sample(&mut random));
        let h = PERIOD / STEPS as f64;
        for step in 0..STEPS {
            let t = k as f64 * PERIOD + step as f64 * h;
            let plus = |by: f64, rate: [f64; 3]| [0, 1, 2].map(|i| state[i] + by * rate[i]);
            let a = rates(t, state);
            let b = rates(t + 0.5 * h, plus(0.5 * h, a));
            let c = rates(t + 0.5 * h, plus(0.5 * h, b));
            let d = rates(t + h, plus(h, c));
            state = [0, 1, 2].map(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
    }
    let time: Vec<f64> = (0..SAMPLES).map(|k| k as f64 * PERIOD).collect();
    let channel = |role, values| Channel {
        role,
        unit: "rad".into(),
        time: time.clone(),
        columns: vec![values],
    };
    let moved = time.iter().map(|t| motor(*t)[0]).collect();
    let recording = Recording {
        payload: None,
        name: "moves".into(),
        channels: vec![
            channel(Role::MotorPosition, moved),
            channel(Role::LinkPosition, seen),
        ],
    };
    let text = "kind = \"flexible_joint\"\nnatural_frequency_hz = 6.2\ndamping_ratio = 0.035\n";
    (Model::from_toml(text, "model.toml").unwrap(), recording)
}

/// What a diagnosis names.
fn named((model, recording): (Model, Recording)) -> Diagnosis {
    let outcome = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {});
    let said = outcome.unwrap().diagnosis;
    println!("{}", said.summary);
    assert_eq!(said.verdict, Verdict::Named, "{}", said.summary);
    said
}

/// Values of the parameters of a finding whose names begin so.
fn told(said: &Diagnosis, effect: &str, name: &str) -> Vec<f64> {
    let finding = said.findings.iter().find(|own| own.effect == effect);
    let finding = finding.unwrap_or_else(|| panic!("no {effect}: {}", said.summary));
    let own = finding.parameters.iter();
    let own = own.filter(|own| own.name.starts_with(name));
    own.map(|own| own.value).collect()
}

/// Two knocks beside a drag are told with how long they lasted: their half sines and parabolas differ by 5 %.
#[test]
fn a_sensor_of_positions_shows_how_long_knocks_last() {
    let knocks = [(3.71, 0.016, 0.06), (7.43, 0.011, -0.05)];
    let said = named(recorded(3e-6, |t, [_, v], _, _| {
        let push = knocks.map(|(time, duration, jump)| {
            let turn = PI * (t - time) / duration;
            let inside = turn.abs() < 0.5 * PI;
            let height = 0.5 * PI * jump / duration;
            if inside { height * turn.cos() } else { 0.0 }
        });
        [push.iter().sum::<f64>() - 0.06 * v * v.abs(), 0.0]
    }));
    assert_eq!(said.findings.len(), 2, "{}", said.summary);
    assert_eq!(told(&said, "quadratic_drag", "coefficient").len(), 1);
    let mut found = told(&said, "external_disturbance", "duration");
    found.sort_by(|a, b| b.total_cmp(a));
    assert_eq!(found.len(), 2, "{}", said.summary);
    for (found, knock) in found.iter().zip(knocks) {
        assert!((found / knock.1 - 1.0).abs() < 0.2, "{found}: {knock:?}");
    }
}

/// A stop that the ringing alone touches, much slower than the axis moves, and that takes most of each impact.
#[test]
fn a_stop_that_takes_slow_impacts_is_named() {
    let (position, hardness, dissipation) = (1.011, 5.0, 3.0);
    let said = named(recorded(1e-5, |_, [y, v], _, _| {
        let depth = y - position;
        let push = depth * (1.0 + dissipation * v);
        let touches = depth > 0.0 && push > 0.0;
        let stiffness = hardness * FREQUENCY * FREQUENCY;
        [if touches { -stiffness * push } else { 0.0 }, 0.0]
    }));
    assert_eq!(said.findings.len(), 1, "{}", said.summary);
    let found = told(&said, "end_stop", "position")[0];
    assert!((found - position).abs() < 1e-4, "{found}");
    let found = told(&said, "end_stop", "dissipation")[0];
    assert!((found / dissipation - 1.0).abs() < 0.3, "{found}");
}

/// Bristles of the LuGre model across the joint are named, and no hysteretic spring beside them.
#[test]
fn bristles_with_a_stribeck_curve_are_named() {
    let stiffness = FREQUENCY * FREQUENCY;
    let (friction, distance, excess, stribeck) = (3e-4, 1.5e-3, 0.4, 0.05);
    let said = named(recorded(8e-6, |_, _, [_, slip], z| {
        let level = 1.0 + excess * (-(slip / stribeck).powi(2)).exp();
        let rate = (slip - slip.abs() * z / level) / distance;
        [-stiffness * friction * (z + 1e-3 * rate), rate]
    }));
    assert_eq!(said.findings.len(), 1, "{}", said.summary);
    assert_eq!(
        told(&said, "presliding_hysteresis", "friction").len(),
        1,
        "{}",
        said.summary
    );
    let others = &said.findings[0].alternatives;
    assert!(others.is_empty(), "{}", said.summary);
}

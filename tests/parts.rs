//! A prediction whose motion is not kept is that of the whole motion, to the bit.

use quell::model::{
    Departure, Experiment, Model, StartComponent, predict_windows, simulate_windows,
};
use quell::recording::{Channel, Recording, Role};
use std::f64::consts::TAU;

/// Samples of the input: a motion of several parts.
const COUNT: usize = 50_000;

fn channel(role: Role, unit: &str, time: Vec<f64>, f: impl Fn(f64) -> f64) -> Channel {
    Channel {
        role,
        unit: unit.into(),
        columns: vec![time.iter().map(|t| f(*t)).collect()],
        time,
    }
}

/// A motor side that hardly rests, sensors with rates of their own that start before it and end after it.
fn recording(input: Role, outputs: &[(Role, &str)]) -> Recording {
    let stamps = |rate: f64, from: f64, count: usize| -> Vec<f64> {
        (0..count).map(|k| from + k as f64 / rate).collect()
    };
    let motion = |t: f64| 0.3 * (TAU * 0.7 * t).sin() + 0.1 * (TAU * 0.11 * t).cos();
    let mut channels = vec![channel(input, "rad", stamps(250.0, 0.0, COUNT), motion)];
    for (index, (role, unit)) in outputs.iter().enumerate() {
        let rate = 170.0 + 41.0 * index as f64;
        let count = (COUNT as f64 * rate / 250.0) as usize;
        let time = stamps(rate, 0.003 * index as f64, count);
        channels.push(channel(*role, unit, time, |t| 1e-3 * (50.0 * t).sin()));
    }
    Recording {
        name: "parts".into(),
        payload: None,
        channels,
    }
}

#[test]
fn a_motion_in_parts_shows_what_the_whole_shows() {
    let joint = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.05\n";
    let effect = |name: &str, place: &str, parameters: &str| {
        format!(
            "[[effect]]\nname = \"{name}\"\nplace = \"{place}\"\n[effect.parameters]\n{parameters}\n"
        )
    };
    let effects = [
        String::new(),
        effect("sensor_lag", "sensor", "time_constant = 4e-3")
            + &effect(
                "sensor_lag_second_order",
                "sensor",
                "time_constant = 2e-3\ndamping_ratio = 0.7",
            ),
        effect(
            "second_mode",
            "link",
            "share = 0.1\nnatural_frequency = 120.0\ndamping_ratio = 0.03",
        ) + &effect("clock_skew", "sensor", "skew = 1e-4"),
        effect("coulomb_friction", "transmission", "friction = 1e-3")
            + &effect("sensor_delay", "sensor", "delay = 3e-3"),
    ];
    let outputs = [
        (Role::LinkPosition, "rad"),
        (Role::Deformation, "rad"),
        (Role::LinkAcceleration, "rad/s^2"),
    ];
    let recording = recording(Role::MotorPosition, &outputs);
    for effects in effects {
        let model = Model::from_toml(&(joint.to_string() + &effects), "model.toml").unwrap();
        let experiment = Experiment::new(&model, &recording).unwrap();
        let (keys, terms) = (model.keys(), model.terms());
        let mut start = Departure::default();
        start[StartComponent::Deformation] = 1e-3;
        start[StartComponent::DeformationRate] = 0.02;
        let starts = [start];
        let clocks = [0.004, -0.003, 0.0];
        let whole = simulate_windows(model.kind, &keys, &terms, &experiment, &starts);
        assert!(whole.trace.time.len() > 2 * 16_384, "one part");
        let parts = predict_windows(model.kind, &keys, &terms, &experiment, &starts, &clocks);
        for ((output, clock), part) in experiment.outputs.iter().zip(clocks).zip(parts) {
            let expected = whole.predict(output, clock);
            let moves = expected.values.iter().any(|v| v.abs() > 1e-6);
            assert!(moves && expected.values.len() == output.time.len());
            assert!(
                part.values == expected.values,
                "{:?} {effects}",
                output.role
            );
            assert!(part.rates == expected.rates, "{:?} {effects}", output.role);
        }
    }
}

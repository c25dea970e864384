//! Forces and inertias that are known over time, against closed forms.

mod shown;

use quell_model::{Experiment, Model};
use quell_recording::{Channel, Recording, Role};
use shown::shown;
use std::f64::consts::TAU;

const SPAN: f64 = 2.0;

fn channel(role: Role, unit: &str, rate: f64, of: impl Fn(f64) -> f64) -> Channel {
    let time: Vec<f64> = (0..=(SPAN * rate) as usize)
        .map(|k| k as f64 / rate)
        .collect();
    Channel {
        role,
        unit: unit.into(),
        columns: vec![time.iter().map(|t| of(*t)).collect()],
        time,
    }
}

fn recording(channels: Vec<Channel>) -> Recording {
    Recording {
        name: "arm".into(),
        payload: None,
        channels,
    }
}

/// What a model predicts of the first output of a recording, and its stamps.
fn predicted(model: &str, channels: Vec<Channel>) -> (Vec<f64>, Vec<f64>) {
    let model = Model::from_toml(model, "model.toml").unwrap();
    let mut experiment = Experiment::of(&model, recording(channels)).unwrap();
    // In one piece from the start on.
    experiment.windows.clear();
    let values = shown(&model, &model.terms(), &experiment);
    (experiment.outputs[0].time.clone(), values)
}

fn furthest((time, values): &(Vec<f64>, Vec<f64>), truth: impl Fn(f64) -> f64) -> f64 {
    let errors = time.iter().zip(values).map(|(t, v)| (v - truth(*t)).abs());
    errors.fold(0.0, f64::max)
}

fn refused(model: &str, channels: Vec<Channel>) -> String {
    let model = Model::from_toml(model, "model.toml").unwrap();
    let refused = Experiment::of(&model, recording(channels)).err();
    refused.expect("a refusal").to_string()
}

const AXIS: &str = "kind = \"rigid_axis\"\nmass = 0.5\n";

/// `(m + J_0 + J_1 t) u'' = T`: `u' = T / J_1 ln(1 + J_1 t / (m + J_0))`. Half of the torque is the drive's, half is known.
#[test]
fn val_an_axis_whose_inertia_grows() {
    let (half, j0, j1) = (0.35, 0.4, 0.6);
    let shown = predicted(
        AXIS,
        vec![
            channel(Role::Torque, "N.m", 500.0, |_| half),
            channel(Role::KnownForce, "N.m", 300.0, |_| half),
            channel(Role::Inertia, "kg.m^2", 200.0, |t| j0 + j1 * t),
            channel(Role::MotorVelocity, "rad/s", 500.0, |_| 0.0),
        ],
    );
    let truth = |t: f64| 2.0 * half / j1 * (1.0 + j1 * t / (0.5 + j0)).ln();
    // The step of 2 ms to the fourth power is far below.
    assert!(furthest(&shown, truth) < 1e-11);
}

/// A link on a motor side at rest is bent by `F / k`, `k = w^2 J`: from the start on, as it is in equilibrium.
#[test]
fn val_a_known_torque_bends_a_joint() {
    let model = "kind = \"flexible_joint\"\nnatural_frequency_hz = 5\ndamping_ratio = 0.05\nlink_inertia = 2.5\n";
    let shown = predicted(
        model,
        vec![
            channel(Role::MotorPosition, "rad", 500.0, |_| 0.3),
            channel(Role::KnownForce, "N.m", 100.0, |_| -12.0),
            channel(Role::Inertia, "kg.m^2", 100.0, |_| 1.7),
            channel(Role::Deformation, "rad", 500.0, |_| 0.0),
        ],
    );
    let bent = -12.0 / ((5.0 * TAU).powi(2) * 2.5);
    assert!(furthest(&shown, |_| bent) < 1e-12 * bent.abs().max(1.0));
}

/// An inertia four times as large halves the frequency: the same as the model that says so, whether it is told in
/// kg.m^2 or as a factor.
#[test]
fn an_inertia_that_is_known_stands_for_that_of_the_model() {
    let shaken = |t: f64| 0.2 * (9.0 * t).sin();
    let of = |model: &str, inertia: Option<Channel>| {
        let mut channels = vec![
            channel(Role::MotorPosition, "rad", 1000.0, shaken),
            channel(Role::LinkPosition, "rad", 1000.0, |_| 0.0),
        ];
        channels.extend(inertia);
        predicted(model, channels)
    };
    let joint = |f: f64, xi: f64| {
        format!(
            "kind = \"flexible_joint\"\nnatural_frequency_hz = {f}\ndamping_ratio = {xi}\nlink_inertia = 0.5\n"
        )
    };
    let truth = of(&joint(3.0, 0.05), None);
    for (unit, value) in [("kg.m^2", 2.0), ("1", 4.0)] {
        let inertia = channel(Role::Inertia, unit, 10.0, |_| value);
        let shown = of(&joint(6.0, 0.1), Some(inertia));
        let apart = shown.1.iter().zip(&truth.1).map(|(a, b)| (a - b).abs());
        // Both are integrated in steps of their own.
        assert!(apart.fold(0.0, f64::max) < 1e-6, "{unit}");
    }
}

/// A motor side that has only a velocity moves a joint as its position does.
#[test]
fn val_a_velocity_stands_for_a_position() {
    let model = "kind = \"flexible_joint\"\nnatural_frequency_hz = 5\ndamping_ratio = 0.05\n";
    let of = |input: Channel| {
        let bent = channel(Role::Deformation, "rad", 500.0, |_| 0.0);
        predicted(model, vec![input, bent]).1
    };
    // From rest: (1 - cos)^2.
    let position = |t: f64| 0.1 * (1.0 - (6.0 * t).cos()).powi(2);
    let velocity = |t: f64| 1.2 * (1.0 - (6.0 * t).cos()) * (6.0 * t).sin();
    let one = of(channel(Role::MotorPosition, "rad", 500.0, position));
    let other = of(channel(Role::MotorVelocity, "rad/s", 500.0, velocity));
    let apart = one.iter().zip(&other).map(|(a, b)| (a - b).abs());
    let size = one.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    assert!(apart.fold(0.0, f64::max) < 1e-6 * size);
}

#[test]
fn what_does_not_fit_the_equation_is_refused_with_its_place() {
    let torque = || channel(Role::Torque, "N.m", 500.0, |_| 1.0);
    let current = || channel(Role::MotorCurrent, "A", 500.0, |_| 1.0);
    let position = || channel(Role::MotorPosition, "rad", 500.0, |_| 0.0);
    let known = |unit: &str| channel(Role::KnownForce, unit, 500.0, |_| 1.0);
    let said = refused(AXIS, vec![torque(), known("N"), position()]);
    assert!(said.contains("known_force of \"arm\" is in N; the model's equation takes N.m"));
    let said = refused(AXIS, vec![current(), known("N.m"), position()]);
    assert!(said.contains("takes A") && said.contains("force_gain"));
    let falls = channel(Role::Inertia, "kg.m^2", 10.0, |t| 0.45 - t);
    let said = refused(AXIS, vec![torque(), falls, position()]);
    assert!(
        said.contains("inertia of \"arm\" is -1.55 kg.m^2 at 2 s"),
        "{said}"
    );
    let joint = "kind = \"flexible_joint\"\nnatural_frequency_hz = 5\ndamping_ratio = 0.05\n";
    let bent = channel(Role::Deformation, "rad", 500.0, |_| 0.0);
    let said = refused(joint, vec![position(), known("N.m"), bent.clone()]);
    assert!(said.contains("link_inertia"));
    let spring = "kind = \"oscillator\"\nstiffness = 5\n";
    let inertia = channel(Role::Inertia, "1", 10.0, |_| 1.0);
    let said = refused(spring, vec![position(), torque(), inertia]);
    assert!(said.contains("has none"));
    let given = "kind = \"rigid_axis\"\nmass = 0.5\nforce_gain = 1\n";
    let model = Model::from_toml(given, "model.toml").unwrap();
    let taken = recording(vec![current(), known("N.m"), position()]);
    assert!(Experiment::of(&model, taken).is_ok());
}

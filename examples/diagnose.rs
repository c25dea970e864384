//! Says what a model of an axis lacks: here dry friction, which the recording has.

use quell::diagnosis::{Options, diagnose};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::from_toml(
        "kind = \"rigid_axis\"\nmass = 95.0\nviscous = 200.0",
        "model.toml",
    )?;
    // Instead: Recording::from_path("my_recording.toml")?.
    let recording = recorded();
    let outcome = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {})?;
    println!("{}", outcome.diagnosis.summary);
    println!("{}", outcome.to_toml());
    Ok(())
}

/// An axis with 20 N of dry friction, at 1 kHz: `m u'' = F - b u' - F_c sign u'`.
fn recorded() -> Recording {
    let time: Vec<f64> = (0..10_000).map(|k| k as f64 * 1e-3).collect();
    let force: Vec<f64> = time
        .iter()
        .map(|t| 80.0 * (5.0 * t).sin() + 40.0 * (3.1 * t).cos())
        .collect();
    let (mut position, mut velocity) = (0.0f64, 0.0f64);
    let motor = force.iter().map(|force| {
        // What an encoder of 10 um tells.
        let read = (position / 1e-5).round() * 1e-5;
        for _ in 0..10 {
            let friction = 20.0 * (velocity / 1e-4).tanh();
            velocity += 1e-4 / 95.0 * (force - 200.0 * velocity - friction);
            position += 1e-4 * velocity;
        }
        read
    });
    let motor = motor.collect();
    let channel = |role, unit: &str, values| Channel {
        role,
        unit: unit.into(),
        time: time.clone(),
        columns: vec![values],
    };
    Recording {
        name: "axis".into(),
        payload: None,
        channels: vec![
            channel(Role::Force, "N", force),
            channel(Role::MotorPosition, "m", motor),
        ],
    }
}

//! A drive that is late behind a position loop.

mod shown;

use quell_model::{Experiment, Model};
use quell_recording::{Channel, Recording, Role};
use shown::shown;

const AXIS: &str =
    "kind = \"rigid_axis\"\nmass = 2\nviscous = 5\nposition_gain = 20\nvelocity_gain = 100\n";

/// What a model makes of a command that jumps at an instant.
fn predicted(model: &str, jump: f64) -> Vec<f64> {
    let model = Model::from_toml(model, "model.toml").unwrap();
    let time: Vec<f64> = (0..800).map(|k| f64::from(k) * 0.002).collect();
    let channel = |role, values| Channel {
        role,
        unit: "rad".into(),
        columns: vec![values],
        time: time.clone(),
    };
    let command = time.iter().map(|t| f64::from(u8::from(*t >= jump - 1e-9)));
    let channels = vec![
        channel(Role::CommandPosition, command.collect()),
        channel(Role::MotorPosition, vec![0.0; time.len()]),
    ];
    let recording = Recording {
        name: "axis".into(),
        payload: None,
        channels,
    };
    let experiment = Experiment::of(&model, recording).unwrap();
    shown(&model, &model.terms(), &experiment)
}

/// The reference comes late, and all that follows from it.
#[test]
fn a_delay_is_that_of_the_reference() {
    let late =
        format!("{AXIS}[[effect]]\nname = \"drive_delay\"\n[effect.parameters]\ndelay = 0.05\n");
    let (shown, truth) = (predicted(&late, 0.4), predicted(AXIS, 0.45));
    let worst = shown.iter().zip(&truth).map(|(a, b)| (a - b).abs());
    assert!(worst.fold(0.0, f64::max) < 1e-12);
    assert!(truth[799] > 0.9);
}

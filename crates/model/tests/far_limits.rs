//! What a further mode becomes if its own frequency is far above the motion.

mod shown;

use quell_model::effects::{EFFECTS, ParameterRole};
use quell_model::{Experiment, Model, Term};
use quell_recording::{Channel, Recording, Role};
use shown::shown;
use std::f64::consts::TAU;

const JOINT: &str = "kind = \"flexible_joint\"\nnatural_frequency_hz = 3\ndamping_ratio = 0.02\n";
/// Part of the deformation that the further mode takes.
const SHARE: f64 = 0.2;

/// A move of a second, and the rest after it, seen by a sensor of positions.
fn moved(model: &Model) -> Experiment {
    let time: Vec<f64> = (0..3000).map(|k| f64::from(k) * 0.001).collect();
    let smooth = |t: f64| t * t * t * (10.0 - t * (15.0 - 6.0 * t));
    let channel = |role| Channel {
        role,
        unit: "rad".into(),
        columns: vec![time.iter().map(|t| smooth(t.min(1.0))).collect()],
        time: time.clone(),
    };
    let recording = Recording {
        name: "arm".into(),
        payload: None,
        channels: vec![channel(Role::MotorPosition), channel(Role::LinkPosition)],
    };
    Experiment::of(model, recording).unwrap()
}

/// `(1 - s) d + s d_2` is `(1 - s) d`, if `d_2` vanishes with `1 / w_2^2`.
#[test]
fn val_a_mode_far_above_the_motion_is_its_far_limit() {
    let model = Model::from_toml(JOINT, "model.toml").unwrap();
    let experiment = moved(&model);
    let seen = |terms: &[Term]| shown(&model, terms, &experiment);
    let apart = |a: &[f64], b: &[f64]| {
        let square = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
        square.sum::<f64>().sqrt()
    };
    let bare = seen(&[]);
    let mut tried = 0;
    for effect in EFFECTS {
        let mode = |frequency| {
            let of = |parameter: &quell_model::effects::Parameter| match parameter.role {
                ParameterRole::Size => SHARE,
                ParameterRole::Frequency => TAU * frequency,
                _ => parameter.neutral,
            };
            let values = effect.parameters.iter().map(of).collect();
            seen(&[Term::new(effect, effect.places[0], values)])
        };
        for far in effect.far_limits() {
            let limit = seen(&[Term::new(far, far.places[0], vec![-SHARE])]);
            let misses = [30.0, 60.0].map(|f| apart(&mode(f), &limit) / apart(&limit, &bare));
            println!("{} as {}: {misses:?}", effect.name, far.name);
            // The mode has about (3 Hz / 30 Hz)^2 of the deformation, and with twice the frequency a quarter of it.
            assert!(misses[0] < 0.02 && misses[1] < 0.3 * misses[0]);
            tried += 1;
        }
    }
    assert_eq!(tried, 2, "second mode and mode of the base");
}

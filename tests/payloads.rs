//! Recordings of one joint that carries different payloads.

use quell::diagnosis::{Options, Verdict, carrying, diagnose, predict};
use quell::model::{Departure, Experiment, Model, simulate};
use quell::recording::{Channel, Recording, Role};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::num::NonZeroUsize;

const NOISE: f64 = 1e-5;
const RATE: f64 = 250.0;
const BELIEVED: &str =
    "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.2\ndamping_ratio = 0.06\n";

fn model(hertz: f64, damping: f64) -> Model {
    let mut model = Model::from_toml(BELIEVED, "model.toml").unwrap();
    (model.values[0].value, model.values[1].value) = (hertz, damping);
    model
}

/// Two moves of a joint of 8 Hz without payload; `inertia` is that of its link over the one without.
fn carried(payload: &str, inertia: f64) -> Recording {
    let time: Vec<f64> = (0..1000).map(|k| f64::from(k) / RATE).collect();
    let smooth = |s: f64| {
        let s = s.clamp(0.0, 1.0);
        s.powi(4) * (35.0 + s * (-84.0 + s * (70.0 - 20.0 * s)))
    };
    let at = |t: &f64| 0.4 * smooth((t - 0.3) / 0.3) - 0.3 * smooth((t - 2.0) / 0.35);
    let channel = |role, values| Channel {
        role,
        unit: "rad".into(),
        time: time.clone(),
        columns: vec![values],
    };
    let recording = |link| Recording {
        payload: Some(payload.into()),
        name: payload.into(),
        channels: vec![
            channel(Role::MotorPosition, time.iter().map(at).collect()),
            channel(Role::LinkPosition, link),
        ],
    };
    let model = model(8.0, 0.05);
    let experiment = Experiment::new(&model, &recording(vec![0.0; time.len()])).unwrap();
    let keys = model.kind.loaded(&model.keys(), inertia);
    let motion = simulate(model.kind, &keys, &[], &experiment, &Departure::default());
    let mut random = ChaCha8Rng::seed_from_u64(inertia.to_bits());
    let seen = motion.predict(&experiment.outputs[0], 0.0).values;
    let noisy = seen
        .iter()
        .map(|y| y + NOISE * random.sample::<f64, _>(StandardNormal));
    recording(noisy.collect())
}

/// A model says nothing of its payload. Beside the score with its inertia stands that with the inertia of the recording.
#[test]
fn val_a_score_tells_the_inertia_of_another_payload() {
    let model = model(8.0, 0.05);
    for (payload, inertia) in [("0 kg", 1.0), ("5 kg", 1.9)] {
        let recording = carried(payload, inertia);
        let (_, score) = predict(&model, recording.clone()).unwrap();
        assert_eq!(score.rms_over_noise < 1.1, inertia == 1.0, "{score:?}");
        let own = carrying(&model, &recording, None)
            .unwrap()
            .expect("a payload");
        assert_eq!(own.payload, payload);
        assert!(
            (own.relative_inertia / inertia - 1.0).abs() < 2e-3,
            "{own:?}"
        );
        assert!(own.score.rms_over_noise < 1.1, "{own:?}");
        let nothing_follows = carrying(&model, &recording, NonZeroUsize::new(usize::MAX));
        assert!(nothing_follows.is_err(), "{nothing_follows:?}");
        let nameless = Recording {
            payload: None,
            ..recording
        };
        assert_eq!(carrying(&model, &nameless, None).unwrap(), None);
    }
}

/// The inertia with each payload is found, and the scores are those with it.
#[test]
fn val_each_payload_has_its_inertia_and_its_score() {
    let inertias = [("0 kg", 1.0), ("1 kg", 1.18), ("5 kg", 1.9)];
    let recordings = inertias.map(|(payload, inertia)| carried(payload, inertia));
    let believed = model(8.2, 0.06);
    let outcome = diagnose(&believed, &recordings, &[], &Options::default(), &|_, _| {});
    let diagnosis = outcome.expect("a diagnosis").diagnosis;
    assert_eq!(diagnosis.verdict, Verdict::NoMismatch);
    for (payload, inertia) in &inertias[1..] {
        let told = diagnosis.nuisances[&format!("relative_inertia_with_payload {payload}")];
        assert!((told / inertia - 1.0).abs() < 2e-3, "{payload}: {told}");
    }
    assert_eq!(diagnosis.fit.scores.len(), 3);
    for own in &diagnosis.fit.scores {
        let over = own.before.rms_over_noise;
        assert!(over < 1.2, "{}: {over}", own.recording);
    }
}

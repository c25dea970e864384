//! Report, document and score say the same of a model and a recording, in the recording's units, as a user types it.

use assert_cmd::Command;
use quell::diagnosis::{Diagnosis, Score, Verdict};
use quell::proof::{Case, Kind, generate, generate_kind};
use quell::recording::{Channel, Recording, Role};
use quell::report::score_line;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use std::path::Path;
use tempfile::TempDir;

fn said(folder: &Path, arguments: &str) -> String {
    let mut command = Command::cargo_bin("quell").unwrap();
    let command = command.current_dir(folder);
    let assert = command
        .args(arguments.split_whitespace())
        .assert()
        .success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

fn scored(folder: &Path, arguments: &str) -> Score {
    serde_json::from_str(&said(folder, &format!("score {arguments} --json"))).unwrap()
}

/// Diagnoses `train`, with `held_out` where it is given, and holds all that is said of the fit against `quell score`
/// of the model that was written.
fn agrees(folder: &Path, held_out: Option<&str>) -> (Diagnosis, String) {
    let apart = held_out.map_or(String::new(), |name| format!(" --held-out {name}"));
    let text = said(folder, &format!("diagnose --model model.toml train{apart}"));
    let html = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    let document = std::fs::read_to_string(folder.join("out/diagnosis.json")).unwrap();
    let diagnosis: Diagnosis = serde_json::from_str(&document).unwrap();
    let names: Vec<&str> = std::iter::once("train").chain(held_out).collect();
    assert_eq!(diagnosis.fit.scores.len(), names.len());
    for (name, told) in names.into_iter().zip(&diagnosis.fit.scores) {
        assert_eq!(told.held_out, name != "train");
        assert_eq!(
            scored(folder, &format!("out/model.toml {name}")),
            told.after
        );
        let scored = said(folder, &format!("score out/model.toml {name}"));
        let line = scored.lines().next().unwrap_or_default();
        assert_eq!(line, score_line(&told.after));
        for place in [&text, &html] {
            assert!(place.contains(line), "no {line} in {place}");
        }
        assert_eq!(told.after.unit, diagnosis.fit.unit);
    }
    assert!(html.contains(&diagnosis.summary) && text.starts_with(&diagnosis.summary));
    (diagnosis, text)
}

/// Of a recording that was held out the fit's own figures are those of its score, where one output is seen in one piece.
#[test]
fn what_is_left_is_the_same_number_wherever_it_is_told() {
    let case = generate(5, 9).unwrap();
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("model.toml"), &case.model).unwrap();
    case.train.write(folder.join("train"), true).unwrap();
    case.test.write(folder.join("held"), true).unwrap();
    let (diagnosis, text) = agrees(folder, Some("held"));
    assert!(!diagnosis.findings.is_empty());
    let fit = &diagnosis.fit;
    for (quality, score) in [
        (fit.before, &fit.scores[1].before),
        (fit.after, &fit.scores[1].after),
    ] {
        let ratio = quality.held_out_rms / score.rms;
        // Equal but for the rounding of a root of a square.
        assert!((ratio - 1.0).abs() < 1e-12, "{quality:?} {score:?}");
    }
    // In the recording's unit first, in times the noise then.
    let change = &diagnosis.summary[diagnosis.summary.find("falls from").unwrap()..];
    let (unit, noise) = (change.find(" rms, "), change.find(" times the noise"));
    assert!(unit.unwrap() < noise.unwrap(), "{change}");
    assert!(text.contains("left: "));
}

/// A model that has friction sees the motion that the diagnosis saw which found it, of an encoder that rounds, too: what
/// sticks stands where it stood then.
#[test]
fn friction_sticks_where_the_diagnosis_saw_it_stick() {
    let is_it = |case: &Case| {
        let [hidden] = &case.truth.effects[..] else {
            return false;
        };
        hidden.effect == "coulomb_friction" && hidden.place == "transmission"
    };
    let mut cases = (0..).map(|index| generate_kind(Kind::Single, 6, index).unwrap());
    let case = cases.find(is_it).unwrap();
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("model.toml"), &case.model).unwrap();
    case.train.write(folder.join("train"), true).unwrap();
    let fit = agrees(folder, None).0.fit;
    let ratio = fit.scores[0].after.rms / fit.after.train_rms;
    // Stretches that were held out are in the score, and not in the fit.
    assert!((0.9..1.1).contains(&ratio), "{fit:?}");
}

/// `m x'' = U - b x' - c sgn(x')` from rest, in steps too short to matter: `m` 0.13 V s^2/rad, `b` 0.5 V s/rad,
/// `c` 0.3 V, white noise of 0.1 mrad.
fn drive(seed: u64, name: &str) -> Recording {
    const STEPS: usize = 100;
    let (rate, count) = (200.0, 1600);
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let levels: Vec<f64> = (0..16).map(|_| random.random_range(-2.0..2.0)).collect();
    let time: Vec<f64> = (0..count).map(|k| k as f64 / rate).collect();
    let voltage: Vec<f64> = (0..count).map(|k| levels[k / 100]).collect();
    let (mut x, mut v) = (0.0f64, 0.0f64);
    let mut seen = Vec::with_capacity(count);
    for u in &voltage {
        let noise: f64 = random.sample(StandardNormal);
        seen.push(x + 1e-4 * noise);
        for _ in 0..STEPS {
            let step = 1.0 / rate / STEPS as f64;
            let push = u - 0.5 * v;
            let friction = match v == 0.0 {
                true => push.clamp(-0.3, 0.3),
                false => 0.3 * v.signum(),
            };
            let next = v + step * (push - friction) / 0.13;
            // What friction stops rests until it is pushed by more.
            v = if v != 0.0 && next * v < 0.0 {
                0.0
            } else {
                next
            };
            x += step * v;
        }
    }
    let channel = |role, unit: &str, values| Channel {
        role,
        unit: unit.into(),
        time: time.clone(),
        columns: vec![values],
    };
    Recording {
        name: name.into(),
        payload: None,
        channels: vec![
            channel(Role::MotorVoltage, "V", voltage),
            channel(Role::MotorPosition, "rad", seen),
        ],
    }
}

/// Nobody said what torque a volt makes: friction is in volts, and nothing is in newton metres. Where it is said,
/// friction is a torque.
#[test]
fn a_drive_in_volts_has_friction_in_volts() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    drive(1, "train").write(folder.join("train"), true).unwrap();
    for (gain, unit, friction) in [
        ("", "V", 0.3),
        ("force_gain = { value = 0.1, fixed = true }\n", "N.m", 0.03),
    ] {
        let scale = if gain.is_empty() { 1.0 } else { 0.1 };
        let model = format!(
            "kind = \"rigid_axis\"\nmass = {{ value = {}, std = {} }}\nviscous = {{ value = {}, std = {} }}\n{gain}",
            0.15 * scale,
            0.05 * scale,
            0.6 * scale,
            0.3 * scale
        );
        std::fs::write(folder.join("model.toml"), model).unwrap();
        let (diagnosis, text) = agrees(folder, None);
        assert_ne!(diagnosis.verdict, Verdict::NoMismatch, "{text}");
        // Coulomb friction and stiction may not be told apart; the first parameter of either is the force that it holds.
        let size = &diagnosis.findings[0].parameters[0];
        assert_eq!(size.unit, unit, "{text}");
        assert!((size.value / friction - 1.0).abs() < 0.05, "{size:?}");
        assert!(text.contains("N.m") == (unit == "N.m"), "{text}");
        // The motion starts anew in windows: the line says so.
        assert!(text.contains("each with a start of its own"), "{text}");
        assert!(text.contains("on windows that were held out"), "{text}");
    }
}

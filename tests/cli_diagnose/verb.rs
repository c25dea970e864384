//! The verbs on recordings of a joint with and without dry friction.

use super::fixtures::{self, FRICTION};
use assert_cmd::Command;
use quell::diagnosis::{Diagnosis, Verdict};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// 3 % off in the frequency, 20 % in the damping.
const MODEL: &str =
    "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.36\ndamping_ratio = 0.06\n";

fn quell(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::cargo_bin("quell").unwrap();
    command
        .current_dir(folder)
        .args(arguments.split_whitespace());
    command
}

/// A folder with the model, a clean recording and one with friction.
fn workplace() -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("model.toml"), MODEL).unwrap();
    for (name, friction) in [("clean", 0.0), ("dry", FRICTION)] {
        let recording = fixtures::recording(name, friction);
        recording.write(folder.path().join(name), true).unwrap();
    }
    folder
}

fn diagnosis(folder: &Path, arguments: &str) -> Diagnosis {
    let assert = quell(folder, arguments).assert().success();
    serde_json::from_slice(&assert.get_output().stdout).unwrap()
}

fn score(folder: &Path, arguments: &str) -> Value {
    let assert = quell(folder, arguments).assert().success();
    serde_json::from_slice(&assert.get_output().stdout).unwrap()
}

#[test]
fn dry_friction_is_named_and_the_model_that_is_written_has_it() {
    let folder = workplace();
    let folder = folder.path();
    let found = diagnosis(folder, "diagnose --model model.toml dry --json --jobs 2");
    assert!(
        matches!(found.verdict, Verdict::Named | Verdict::Ambiguous),
        "{found:?}"
    );
    let finding = &found.findings[0];
    let set: Vec<_> = std::iter::once(&finding.effect)
        .chain(&finding.alternatives)
        .collect();
    let dry = [
        "coulomb_friction",
        "stribeck_friction",
        "presliding_hysteresis",
    ];
    assert!(
        set.iter().any(|name| dry.contains(&name.as_str())),
        "{set:?}"
    );
    assert_eq!(finding.place, "transmission");
    assert!(found.fit.after.held_out_over_noise < 1.1, "{:?}", found.fit);
    assert!(
        found.fit.before.held_out_over_noise > 3.0,
        "{:?}",
        found.fit
    );

    let written = std::fs::read_to_string(folder.join("out/diagnosis.json")).unwrap();
    assert_eq!(serde_json::from_str::<Diagnosis>(&written).unwrap(), found);
    let html = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(html.contains("Diagnosis of dry"));
    let model = std::fs::read_to_string(folder.join("out/model.toml")).unwrap();
    assert!(
        model.contains("[[effect]]") && model.contains(&finding.effect),
        "{model}"
    );

    let before = score(folder, "score model.toml dry --json");
    let after = score(folder, "score out/model.toml dry --json");
    assert!(after["rms_over_noise"].as_f64().unwrap() < 1.1, "{after}");
    assert!(before["rms_over_noise"].as_f64().unwrap() > 3.0, "{before}");
    assert!(after["fit_percent"].as_f64().unwrap() > 95.0, "{after}");
}

#[test]
fn a_model_predicts_a_recording() {
    let folder = workplace();
    let folder = folder.path();
    let told = score(folder, "simulate model.toml clean --out sub/p.csv --json");
    let file = folder.join("sub/p.csv");
    assert_eq!(told["files"], serde_json::json!(["sub/p.csv"]));
    let text = std::fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let header = "time_s,deformation_recorded_rad,deformation_predicted_rad";
    assert_eq!(lines.next(), Some(header));
    let errors = lines.map(|line| {
        let values: Vec<f64> = line
            .split(',')
            .map(|value| value.parse().unwrap())
            .collect();
        (values[1] - values[2]).powi(2)
    });
    let (count, sum) = errors.fold((0.0, 0.0), |(count, sum), error| (count + 1.0, sum + error));
    let scored = score(folder, "score model.toml clean --json");
    assert_eq!(told["score"], scored);
    let rms = scored["rms"].as_f64().unwrap();
    // Equal but for the rounding of a sum of 4329 squares.
    assert!(
        ((sum / count).sqrt() / rms - 1.0).abs() < 1e-9,
        "{sum} {count} {rms}"
    );
}

#[test]
fn nothing_is_found_where_nothing_is_missing() {
    let folder = workplace();
    let folder = folder.path();
    let found = diagnosis(
        folder,
        "diagnose --model model.toml clean --json --out report",
    );
    assert_eq!(found.verdict, Verdict::NoMismatch, "{found:?}");
    assert!(found.findings.is_empty());
    let text = quell(folder, "diagnose --model model.toml clean --out again")
        .assert()
        .success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.starts_with(&found.summary), "{text}");
    assert!(
        text.contains("again/report.html") && text.contains("held out"),
        "{text}"
    );
    let [one, other] = ["report", "again"]
        .map(|out| std::fs::read(folder.join(out).join("diagnosis.json")).unwrap());
    assert!(one == other, "the same input gives the same output");
}

#[test]
fn what_cannot_be_read_is_refused() {
    let folder = workplace();
    std::fs::write(folder.path().join("odd.toml"), "kind = \"teapot\"\n").unwrap();
    for (arguments, said) in [
        ("diagnose --model model.toml", "RECORDING"),
        ("diagnose --model nowhere.toml dry", "nowhere.toml"),
        ("diagnose --model odd.toml dry", "teapot"),
        ("diagnose --model model.toml nowhere", "nowhere"),
        ("diagnose --model model.toml dry --jobs 0", "--jobs"),
        ("diagnose --model model.toml dry --out .", "written over"),
        ("score model.toml nowhere", "nowhere"),
        ("simulate model.toml", "RECORDING"),
        ("simulate model.toml clean --target 3", "--target"),
    ] {
        let assert = quell(folder.path(), arguments).assert().code(2);
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(stderr.contains(said), "{arguments}: {stderr}");
    }
}

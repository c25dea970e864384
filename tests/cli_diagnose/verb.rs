//! The verbs on recordings of machines with and without hidden physics.

use super::fixtures::{self, CLEAN, DAMPED};
use super::schema;
use assert_cmd::Command;
use quell::diagnosis::{Diagnosis, Verdict};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

fn quell(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::cargo_bin("quell").unwrap();
    command
        .current_dir(folder)
        .args(arguments.split_whitespace());
    command
}

/// A folder with a clean recording, one of a machine with another damping, and the models believed of both.
fn workplace() -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, model, which) in [
        ("clean", "clean.toml", CLEAN),
        ("damped", "model.toml", DAMPED),
    ] {
        let case = fixtures::case(which);
        std::fs::write(folder.path().join(model), case.model).unwrap();
        case.train.write(folder.path().join(name), true).unwrap();
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
fn what_is_missing_is_in_the_model_that_is_written() {
    let folder = workplace();
    let folder = folder.path();
    let found = diagnosis(folder, "diagnose --model model.toml damped --json --jobs 2");
    let finding = &found.findings[0];
    let mut set = std::iter::once(&finding.effect).chain(&finding.alternatives);
    assert!(set.any(|name| name == "quadratic_damping"), "{finding:?}");
    let [before, after] = [&found.fit.before, &found.fit.after].map(|fit| fit.held_out_over_noise);
    assert!(after < 0.2 * before, "{:?}", found.fit);

    let written = std::fs::read_to_string(folder.join("out/diagnosis.json")).unwrap();
    assert_eq!(serde_json::from_str::<Diagnosis>(&written).unwrap(), found);
    schema::check(&serde_json::from_str(&written).unwrap());
    let html = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    assert!(html.contains("Diagnosis of "));
    let model = std::fs::read_to_string(folder.join("out/model.toml")).unwrap();
    assert!(
        model.contains("[[effect]]") && model.contains(&finding.effect),
        "{model}"
    );

    let rms = |model: &str| {
        let score = score(folder, &format!("score {model} damped --json"));
        score["rms_over_noise"].as_f64().unwrap()
    };
    let [before, after] = ["model.toml", "out/model.toml"].map(rms);
    assert!(after < 0.2 * before, "{before} to {after}");
}

#[test]
fn a_model_predicts_a_recording() {
    let folder = workplace();
    let folder = folder.path();
    let told = score(folder, "simulate clean.toml clean --out sub/p.csv --json");
    let file = folder.join("sub/p.csv");
    assert_eq!(told["files"], serde_json::json!(["sub/p.csv"]));
    let text = std::fs::read_to_string(file).unwrap();
    let mut lines = text.lines();
    let header: Vec<_> = lines.next().unwrap().split(',').collect();
    let [time, recorded, predicted] = header[..] else {
        panic!("{header:?}");
    };
    assert_eq!(time, "time_s");
    assert_eq!(recorded.replace("_recorded_", "_predicted_"), predicted);
    let errors = lines.map(|line| {
        let values: Vec<f64> = line
            .split(',')
            .map(|value| value.parse().unwrap())
            .collect();
        (values[1] - values[2]).powi(2)
    });
    let (count, sum) = errors.fold((0.0, 0.0), |(count, sum), error| (count + 1.0, sum + error));
    let scored = score(folder, "score clean.toml clean --json");
    assert_eq!(told["score"], scored);
    let rms = scored["rms"].as_f64().unwrap();
    // Equal but for the rounding of a sum of squares.
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
        "diagnose --model clean.toml clean --json --out report",
    );
    assert_eq!(found.verdict, Verdict::NoMismatch, "{found:?}");
    assert!(found.findings.is_empty());
    let text = quell(folder, "diagnose --model clean.toml clean --out again")
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
        ("diagnose --model clean.toml", "RECORDING"),
        ("diagnose --model nowhere.toml damped", "nowhere.toml"),
        ("diagnose --model odd.toml damped", "teapot"),
        ("diagnose --model clean.toml nowhere", "nowhere"),
        ("diagnose --model model.toml damped --jobs 0", "--jobs"),
        ("diagnose --model model.toml damped --out .", "written over"),
        ("score clean.toml nowhere", "nowhere"),
        ("simulate clean.toml", "RECORDING"),
        ("simulate clean.toml clean --target 3", "--target"),
    ] {
        let assert = quell(folder.path(), arguments).assert().code(2);
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(stderr.contains(said), "{arguments}: {stderr}");
    }
}

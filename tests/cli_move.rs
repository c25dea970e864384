//! `quell move` as a user types it, several joints on a path, and mistypes it: what it refuses, and in which words.

use assert_cmd::Command;
use quell::recording::{Recording, Role};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// The SCARA of the examples, of which only joint 1 rings.
const SCARA: &str = include_str!("../examples/robots/scara.toml");

/// The same with a mode in joint 2.
fn both_ring() -> String {
    let mode = "mode = [{ frequency_hz = 17.0, damping_ratio = 0.05, damping = \"across_joint\" }]";
    SCARA.replace("home_deg = 30.0\n", &format!("home_deg = 30.0\n{mode}\n"))
}

fn on_a_path(folder: &Path, arguments: &str) -> Vec<u8> {
    let mut command = Command::cargo_bin("quell").unwrap();
    let arguments = format!("move --robot arm.toml --path {arguments}");
    command.current_dir(folder).args(arguments.split(' '));
    command.assert().success().get_output().stdout.clone()
}

#[test]
fn two_joints_keep_their_path_with_a_common_train_and_leave_it_without() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("arm.toml"), both_ring()).unwrap();
    let told: Value = serde_json::from_slice(&on_a_path(folder, "--target 30,45 --json")).unwrap();
    let names = told["moves"].as_array().unwrap().iter();
    let names: Vec<_> = names.map(|one| one["name"].as_str().unwrap()).collect();
    let expected = [
        "unshaped",
        "own_trains_first",
        "own_trains_next",
        "common_train_first",
        "common_train_next",
    ];
    assert_eq!(names, expected);
    for (index, name) in names.iter().enumerate() {
        let one = &told["moves"][index];
        let away = one["path_deviation_deg"].as_f64().unwrap();
        match name.starts_with("own") {
            // The trains lag by half a period of each mode and more: some 15 ms apart at 100 deg/s.
            true => assert!(away > 0.5, "{one:#}"),
            // Rounding of positions of up to 90 degrees.
            false => assert!(away < 1e-12, "{one:#}"),
        }
        for joint in 0..2 {
            let residual = one["joints"][joint]["percent_of_unshaped"]
                .as_f64()
                .unwrap();
            assert!(!name.ends_with("next") || residual < 5.0, "{one:#}");
            let recording = folder.join(format!("out/{name}/joint_{}", joint + 1));
            let recording = Recording::from_path(recording).unwrap();
            assert!(recording.channel(Role::TipPosition).is_some());
        }
    }
    let html = std::fs::read_to_string(folder.join("out/report.html")).unwrap();
    for words in ["Joints 1, 2 move on a path", "off the path, common train"] {
        assert!(html.contains(words), "{words}");
    }
    assert!(folder.join("out/model_joint_2.toml").exists());
}

#[test]
fn a_stiff_joint_waits_for_one_that_rings() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("arm.toml"), SCARA).unwrap();
    let told = on_a_path(folder.path(), "--target 20,-30,0");
    let told = String::from_utf8(told).unwrap();
    for words in ["joint 2 by \u{2212}30 deg (stiff)", "common_train_next"] {
        assert!(told.contains(words), "{told}");
    }
    assert!(!folder.path().join("out/model_joint_2.toml").exists());
}

#[test]
fn bad_input_is_refused() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let robot = include_str!("../crates/simulation/src/plant/rx170.toml");
    write(
        "fast.toml",
        &robot.replace("rate_hz = 333.0", "rate_hz = 1e12"),
    );
    write(
        "stiff.toml",
        &robot.replace("frequency_hz = 8.12", "frequency_hz = 1e9"),
    );
    write("file", "");
    write("scara.toml", SCARA);
    for (arguments, words) in [
        ("--target nan", "--target"),
        ("--target 0", "--target 0"),
        ("--target 1e9", "longer than"),
        ("--joint 0", "joints 1 to 6"),
        ("--joint 2", "has no mode"),
        ("--payload -5", "from 0 to 1e9"),
        ("--payload 1e308", "from 0 to 1e9"),
        ("--noise nan", "from 0 to 1e9"),
        ("--noise 1e308", "from 0 to 1e9"),
        ("--residual 1e308", "a percentage above 0, up to 100"),
        ("--residual 0", "a percentage above 0, up to 100"),
        ("--deviation 1e308", "from 1e-9 to 1e9"),
        ("--seed -1", "--seed"),
        ("--velocity 0", "from 1e-9 to 1e9"),
        ("--jerk -3", "from 1e-9 to 1e9"),
        // Moves that the 20 s of simulation would cut off, and beliefs that would fill the memory.
        ("--velocity 0.5", "has not ended after 20 s"),
        ("--belief 1e-9,0.1", "1e-9 Hz"),
        ("--belief-error -100", "a percentage above -100, up to 1e9"),
        ("--belief-error 1e308", "a percentage above -100, up to 1e9"),
        (
            "--belief 1e308,0.1",
            "1e308 Hz is not a number from 1e-9 to 1e9",
        ),
        ("--belief 8,1e308", "damping ratio 1e308 is not in [0, 1)"),
        (
            "--belief 1e9,0.1",
            "a belief of 1e9 Hz is not from 0.1 to 62.5 Hz",
        ),
        (
            "--belief-error 1e9",
            "--belief-error 1e9: the damped frequency",
        ),
        ("--belief 8,1", "[0, 1)"),
        ("--robot .", ".: "),
        ("--robot absent.toml", "absent.toml"),
        ("--robot fast.toml", "tracker.rate_hz"),
        ("--robot stiff.toml", "joint[1].mode[1].frequency_hz"),
        ("--out file", "file"),
        ("--target 30,45", "add --path"),
        ("--path", "--target"),
        ("--path --target 30", "at least two joints"),
        ("--path --target 30,0", "at least two joints"),
        ("--path --target 1,1,1,1,1,1,1", "joints 1 to 6"),
        ("--path --target 0,1,1", "none rings"),
        ("--path --target 30,45 --joint 1", "--joint"),
        (
            "--path --target 30,45 --velocity 0.5",
            "has not ended after 20 s",
        ),
        ("--path --target 1,1,1 --robot scara.toml", "joint 3 slides"),
    ] {
        let mut command = Command::cargo_bin("quell").unwrap();
        command.current_dir(folder.path()).arg("move");
        let assert = command.args(arguments.split(' ')).assert();
        let assert = assert.code(2).stdout("");
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        let told = stderr.starts_with("error: ") && stderr.contains(words);
        assert!(told, "{arguments:?}: no {words:?} in {stderr}");
    }
}

/// A move within a tolerance is faster than with ZVD, and leaves no more than it says.
#[test]
fn a_tolerance_makes_the_move_faster() {
    let folder = TempDir::new().unwrap();
    let mut command = Command::cargo_bin("quell").unwrap();
    let arguments = "move --residual 5 --deviation 0.05 --json";
    command
        .current_dir(folder.path())
        .args(arguments.split(' '));
    let output = command.assert().success().get_output().stdout.clone();
    let told: Value = serde_json::from_slice(&output).unwrap();
    let number = |value: &Value| value.as_f64().unwrap();
    let (next, within) = (&told["moves"][3], &told["moves"][4]);
    assert_eq!(within["name"], "within_tolerance");
    assert!(number(&within["command_s"]) < 0.9 * number(&next["command_s"]));
    let bounds = &told["bounds"];
    assert!(number(&bounds["residual_percent"]) <= 5.0);
    assert!(number(&bounds["vibration_mm"]) <= 0.05);
    assert!(number(&within["residual_mm"]) <= number(&bounds["vibration_mm"]));
    assert!(
        folder
            .path()
            .join("out/within_tolerance/recording.toml")
            .exists()
    );
}

/// Without a deviation the joints keep their line; with one they take no longer, and stay within it.
#[test]
fn a_tolerance_of_several_joints_is_kept() {
    let folder = TempDir::new().unwrap();
    let folder = folder.path();
    std::fs::write(folder.join("arm.toml"), both_ring()).unwrap();
    let run = |out: &str, tolerance: &str| -> Value {
        let arguments = format!("--target 30,-45 --json --out {out} {tolerance}");
        serde_json::from_slice(&on_a_path(folder, &arguments)).unwrap()
    };
    let kept = run("kept", "--residual 2");
    let left = run("left", "--residual 2 --deviation 3");
    let away = |told: &Value| told["moves"][5]["path_deviation_deg"].as_f64().unwrap();
    assert!(away(&kept) < 1e-9);
    assert!(left["bounds"]["path_deviation_mm"].as_f64().unwrap() <= 3.0);
    let command = |told: &Value| told["moves"][5]["command_s"].as_f64().unwrap();
    assert!(command(&left) <= command(&kept) + 1e-9);
}

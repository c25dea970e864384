//! Whole robots: their dynamics against other programs, and the diagnosis of every joint of a moving arm.

mod arm;
#[path = "../absent/python.rs"]
mod python;
#[path = "../absent/skipped.rs"]
mod skipped;

use arm::{Hidden, record};
use assert_cmd::Command;
use nalgebra::Vector3;
use quell::rigid_body::Dynamics;
use quell::signal::read_urdf_tree;
use serde_json::Value;
use std::ffi::OsStr;
use std::path::Path;
use tempfile::TempDir;

/// Torques and inertias of random motions, as Pinocchio and MuJoCo have them.
#[test]
fn val_torques_and_inertias_are_those_of_pinocchio_and_mujoco() {
    for file in [
        "examples/robots/light_arm.urdf",
        "tests/rigid_body/branched.urdf",
    ] {
        let script = ["peers.py", file, "20", "7"].map(OsStr::new);
        let Some(lines) = python::python("rigid_body", "requirements.txt", &script) else {
            return;
        };
        let tree = read_urdf_tree(Path::new(file)).unwrap();
        let arm = Dynamics::new(&tree, Vector3::new(0.0, 0.0, -9.81));
        let lines = String::from_utf8(lines).unwrap();
        assert_eq!(lines.lines().count(), 20);
        for line in lines.lines() {
            let line: Value = serde_json::from_str(line).unwrap();
            let list = |at: &str| -> Vec<f64> {
                let values = line.pointer(at).unwrap().as_array().unwrap();
                values.iter().map(|value| value.as_f64().unwrap()).collect()
            };
            let (torques, inertias) = (
                arm.torques(&list("/q"), &list("/v"), &list("/a")),
                arm.inertias(&list("/q")),
            );
            for peer in ["pinocchio", "mujoco"] {
                for (own, name) in [(&torques, "torques"), (&inertias, "inertias")] {
                    let theirs = list(&format!("/{peer}/{name}"));
                    let size = theirs.iter().fold(1.0f64, |most, v| most.max(v.abs()));
                    for (own, theirs) in own.iter().zip(&theirs) {
                        // Rounding of some hundred operations; the descriptions have six digits, and all read the same.
                        assert!(
                            (own - theirs).abs() < 1e-11 * size,
                            "{file} {peer} {name}: {own} {theirs}"
                        );
                    }
                }
            }
        }
    }
}

/// The overview of an arm in which something is hidden.
fn diagnosed(hidden: &Hidden, seed: u64) -> (Value, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), hidden, 14.0, seed);
    let output = Command::cargo_bin("quell")
        .unwrap()
        .current_dir(folder.path())
        .args([
            "diagnose", "--robot", "two.urdf", ".", "--out", "report", "--json", "-q",
        ])
        .output()
        .unwrap();
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words}");
    (serde_json::from_slice(&output.stdout).unwrap(), folder)
}

fn joint<'a>(overview: &'a Value, name: &str) -> &'a Value {
    let joints = overview["joints"].as_array().unwrap();
    joints.iter().find(|own| own["joint"] == name).unwrap()
}

/// Friction at the elbow is told there, with its size, and nothing at the shoulder that the elbow shakes.
#[test]
fn friction_of_one_joint_is_not_told_at_another() {
    let hidden = Hidden {
        friction: [0.0, 1.5],
        ..Hidden::default()
    };
    let (overview, folder) = diagnosed(&hidden, 1);
    assert_eq!(
        joint(&overview, "shoulder")["findings"],
        serde_json::json!([]),
        "{overview:#}"
    );
    let elbow = joint(&overview, "elbow");
    assert_eq!(
        elbow["findings"],
        serde_json::json!(["coulomb_friction"]),
        "{overview:#}"
    );
    // The worst first.
    assert_eq!(overview["joints"][0]["joint"], "elbow");
    let document = std::fs::read(folder.path().join("report/elbow/diagnosis.json")).unwrap();
    let document: Value = serde_json::from_slice(&document).unwrap();
    let friction = &document["findings"][0]["parameters"][0];
    assert!(
        (friction["value"].as_f64().unwrap() - 1.5).abs() < 0.03,
        "{friction}"
    );
    assert_eq!(friction["unit"], "N.m");
    assert!(overview["recordings"][0]["payload"].is_null());
    let page = std::fs::read_to_string(folder.path().join("report/index.html")).unwrap();
    assert!(page.contains("href=\"elbow/report.html\""));
}

/// A payload and a coupling are told as such, and no physics in their place.
#[test]
fn what_the_description_lacks_is_told_as_such() {
    let hidden = Hidden {
        payload: [0.8, 0.3],
        ..Hidden::default()
    };
    let (overview, _) = diagnosed(&hidden, 2);
    let payload = &overview["recordings"][0]["payload"];
    assert!(
        (payload["mass_kg"].as_f64().unwrap() - 0.8).abs() < 0.05,
        "{overview:#}"
    );
    assert!(
        (payload["centre_m"][0].as_f64().unwrap() - 0.3).abs() < 0.03,
        "{overview:#}"
    );
    let hidden = Hidden {
        coupling: 0.1,
        ..Hidden::default()
    };
    let (coupled, _) = diagnosed(&hidden, 3);
    let couplings = coupled["recordings"][0]["couplings"].as_array().unwrap();
    assert_eq!(couplings.len(), 1, "{coupled:#}");
    let coupling = &couplings[0];
    assert_eq!(
        (&coupling["joint"], &coupling["cause"]),
        (&"elbow".into(), &"acceleration".into())
    );
    assert!(
        (coupling["size"].as_f64().unwrap() - 0.1).abs() < 0.01,
        "{coupled:#}"
    );
    for overview in [overview, coupled] {
        for name in ["shoulder", "elbow"] {
            assert_eq!(
                joint(&overview, name)["findings"],
                serde_json::json!([]),
                "{overview:#}"
            );
        }
    }
}

/// A description with the whole inertia, of joints without rotors; and why a joint that hardly moves has no model.
#[test]
fn an_exact_description_is_diagnosed_and_a_joint_at_rest_is_told_as_such() {
    let hidden = Hidden {
        no_rotors: true,
        friction: [1.5, 0.8],
        ..Hidden::default()
    };
    let (overview, folder) = diagnosed(&hidden, 4);
    for name in ["shoulder", "elbow"] {
        let own = joint(&overview, name);
        let friction = serde_json::json!(["coulomb_friction"]);
        assert_eq!(own["findings"], friction, "{overview:#}");
    }
    let file = folder.path().join("arm.csv");
    let text = std::fs::read_to_string(&file).unwrap();
    let rest = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        let elbow = if cells[2] == "q2" { "q2" } else { "0.7" };
        [cells[0], cells[1], elbow, cells[3], cells[4]].join(",")
    };
    let lines: Vec<String> = text.lines().map(rest).collect();
    std::fs::write(&file, lines.join("\n") + "\n").unwrap();
    let mut quell = Command::cargo_bin("quell").unwrap();
    let quell = quell.current_dir(folder.path());
    let output = quell
        .args([
            "diagnose", "--robot", "two.urdf", ".", "--out", "rest", "-q",
        ])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned()
        + &String::from_utf8_lossy(&output.stderr);
    assert!(said.contains("it hardly moves in the recording"), "{said}");
    assert!(!said.contains("no torque"), "{said}");
}

/// A heavy payload, whose inertia is as large as the link's own, is told with its lever, and no coupling with it.
#[test]
fn a_heavy_payload_is_told_with_its_lever() {
    let hidden = Hidden {
        payload: [1.5, 0.8],
        friction: [1.5, 0.8],
        ..Hidden::default()
    };
    let (overview, _) = diagnosed(&hidden, 5);
    let recording = &overview["recordings"][0];
    let payload = &recording["payload"];
    let number = |at: &str| payload.pointer(at).and_then(Value::as_f64).unwrap();
    assert!((number("/mass_kg") - 1.5).abs() < 0.05, "{payload}");
    assert!((number("/centre_m/0") - 0.8).abs() < 0.02, "{payload}");
    let (lever, std) = (number("/lever_m"), number("/lever_std_m"));
    assert!(0.0 < std && std < 0.02, "{payload}");
    // A false alarm in 16000.
    assert!((lever - 0.8).abs() < 4.0 * std, "{payload}");
    assert_eq!(recording["couplings"], serde_json::json!([]), "{recording}");
}

#[test]
fn what_does_not_suit_is_refused_with_the_joint() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), &Hidden::default(), 2.0, 1);
    let refused = |arguments: &[&str]| {
        let mut quell = Command::cargo_bin("quell").unwrap();
        let quell = quell
            .current_dir(folder.path())
            .arg("diagnose")
            .args(arguments);
        let output = quell.output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let said = refused(&["--robot", "two.urdf", "none"]);
    assert!(said.contains("none"), "{said}");
    std::fs::write(
        folder.path().join("model.toml"),
        "kind = \"rigid_axis\"\nmass = 1\n",
    )
    .unwrap();
    let said = refused(&["--model", "model.toml", "."]);
    assert!(
        said.contains("shoulder, elbow") && said.contains("--robot"),
        "{said}"
    );
    let manifest = folder.path().join("recording.toml");
    let text = std::fs::read_to_string(&manifest).unwrap();
    std::fs::write(&manifest, text.replace("\"elbow\"", "\"elbo\"")).unwrap();
    let said = refused(&["--robot", "two.urdf", "."]);
    assert!(
        said.contains("\"elbo\"") && said.contains("did you mean \"elbow\""),
        "{said}"
    );
}

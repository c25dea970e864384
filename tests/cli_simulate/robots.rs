//! The robots of `examples/robots`, as a user who copies them would use them.

use super::{quell, residual, simulate};
use serde_json::Value;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The examples, with the modes (Hz) of the joint that each moves.
const ROBOTS: [(&str, &[f64]); 2] = [("scara.toml", &[11.4, 27.0]), ("light_arm.toml", &[6.4])];

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/robots")
}

/// A folder with copies of the examples.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    for entry in std::fs::read_dir(examples()).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), folder.path().join(entry.file_name())).unwrap();
    }
    folder
}

fn json(folder: &TempDir, arguments: &[&str]) -> Value {
    let assert = quell(folder.path(), arguments)
        .arg("--json")
        .assert()
        .success();
    serde_json::from_slice(&assert.get_output().stdout).unwrap()
}

#[test]
fn every_example_is_simulated_compared_and_moved() {
    for (robot, frequencies) in ROBOTS {
        let folder = folder();
        let simulated = simulate(folder.path(), &format!("--robot {robot}"));
        let modes = simulated["modes"].as_array().unwrap().iter();
        let told: Vec<f64> = modes
            .map(|mode| mode["frequency_hz"].as_f64().unwrap())
            .collect();
        assert_eq!(told, frequencies, "{robot}");
        let shaped = simulate(folder.path(), &format!("--robot {robot} --shaper zvd"));
        // Shaped for all modes of the joint; what is left is the servo's, not the modes'.
        let ratio = residual(&shaped, 0) / residual(&simulated, 0);
        assert!(ratio < 0.01, "{robot}: {ratio}");

        let inspected = json(&folder, &["inspect", "out"]);
        for channel in inspected["channels"].as_array().unwrap() {
            assert_eq!(
                channel["remarks"].as_array().map(Vec::len),
                Some(0),
                "{robot}: {channel}"
            );
        }
        let compared = json(&folder, &["compare", robot]);
        let unshaped = compared["unshaped_simulated_mm"][2].as_f64().unwrap();
        assert!(
            (unshaped / residual(&simulated, 0) - 1.0).abs() < 1e-6,
            "{robot}: {unshaped} mm"
        );

        let moved = json(&folder, &["move", "--robot", robot, "--out", "moved"]);
        let next = moved["moves"][3]["percent_of_unshaped"].as_f64().unwrap();
        assert!(next < 2.0, "{robot}: {next} %");
    }
}

#[test]
fn other_joints_poses_and_payloads_of_an_example_are_simulated() {
    let folder = folder();
    let arguments = "--robot light_arm.toml --joint 2 --target -20 --pose 0,20,60,0,30,0";
    let empty = simulate(folder.path(), arguments);
    assert!((empty["moves"][0]["start_deg"].as_f64().unwrap() - 20.0).abs() < 1e-9);
    assert!(empty["moves"][0]["target_deg"].as_f64().unwrap().abs() < 1e-9);
    let loaded = simulate(folder.path(), &format!("{arguments} --payload 3"));
    let frequency = |document: &Value| document["modes"][0]["frequency_hz"].as_f64().unwrap();
    assert!(frequency(&loaded) < 0.9 * frequency(&empty), "{loaded}");

    // Joint 5 has no mode: its motor side moves, nothing rings, and there is no model to write.
    let stiff = "--robot light_arm.toml --joint 5 --out stiff";
    let stiff = simulate(folder.path(), stiff);
    assert_eq!(stiff["files"].as_array().map(Vec::len), Some(1), "{stiff}");
    assert_eq!(
        (residual(&stiff, 0), &stiff["modes"]),
        (0.0, &serde_json::json!([]))
    );
    let given = "--robot light_arm.toml --joint 5 --mode 20,0.05";
    assert!(residual(&simulate(folder.path(), given), 0) > 0.0);
    // The SCARA's joint 3 slides: 100 mm down, and no arc to move along.
    let low = "--robot scara.toml --pose 0,30,0.2,0 --out low";
    simulate(folder.path(), low);
    let height = |out: &str| -> f64 {
        let text = std::fs::read_to_string(folder.path().join(out).join("model.toml")).unwrap();
        text.parse::<toml::Table>().unwrap()["tip_height_m"]
            .as_float()
            .unwrap()
    };
    simulate(folder.path(), "--robot scara.toml --out home");
    assert!((height("home") - height("low") - 0.1).abs() < 1e-12);
}

#[test]
fn bad_robots_are_refused_with_file_key_and_value() {
    let folder = folder();
    for (robot, from, to, words) in [
        (
            "scara.toml",
            "home_m = 0.1",
            "home_deg = 5.0",
            "joint[3].home_deg = 5",
        ),
        (
            "scara.toml",
            "home_deg = 30.0",
            "home_m = 0.5",
            "joint[2].home_m = 0.5",
        ),
        (
            "scara.toml",
            "velocity_m_s = 1.0",
            "velocity_deg_s = 60.0",
            "velocity_deg_s = 60",
        ),
        (
            "scara.toml",
            "jerk_m_s3 = 200.0",
            "jerk_m_s3 = -2.0",
            "joint[3].limits.jerk_m_s3 = -2",
        ),
        (
            "scara.toml",
            ", jerk_m_s3 = 200.0",
            "",
            "joint[3].limits.jerk_m_s3 = (missing)",
        ),
        ("scara.toml", "joint = 1", "joint = 3", "move.joint = 3"),
        (
            "scara.toml",
            "damping_ratio = 0.03,",
            "damping_ratio = 1.0,",
            "joint[1].mode[2].damping_ratio = 1",
        ),
        (
            "scara.toml",
            "rate_hz = 500.0",
            "rate_hz = inf",
            "tracker.rate_hz = inf",
        ),
        (
            "scara.toml",
            ", slides = true",
            ", sliding = true",
            "sliding",
        ),
        ("scara.toml", "name = \"SCARA on a column\"", "", "name"),
        (
            "scara.toml",
            "name = \"SCARA",
            "tip_link = \"hand\"\nname = \"SCARA",
            "tip_link = hand",
        ),
        (
            "light_arm.toml",
            "light_arm.urdf",
            "heavy_arm.urdf",
            "heavy_arm.urdf",
        ),
        (
            "light_arm.toml",
            "tip_link = \"flange\"",
            "tip_link = \"hook\"",
            "\"hook\"",
        ),
        (
            "light_arm.toml",
            "\"elbow\"",
            "\"knee\"",
            "joint[3].name = knee",
        ),
        (
            "light_arm.toml",
            "home_deg = 35.0",
            "link = { mass_kg = 3.0, centre_m = [0, 0, 0] }",
            "joint[2].link",
        ),
        (
            "light_arm.urdf",
            "value=\"6.0\"",
            "value=\"six\"",
            "light_arm.urdf",
        ),
        (
            "light_arm.urdf",
            "type=\"revolute\"",
            "type=\"floating\"",
            "\"base_yaw\" is Floating",
        ),
    ] {
        let path = folder.path().join(robot);
        let good = std::fs::read_to_string(&path).unwrap();
        assert!(good.contains(from), "{robot}: no {from:?}");
        std::fs::write(&path, good.replacen(from, to, 1)).unwrap();
        let described = robot.replace(".urdf", ".toml");
        let arguments = ["simulate", "--robot", &described];
        let assert = quell(folder.path(), &arguments).assert().code(2).stdout("");
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        for word in [robot, words] {
            assert!(
                stderr.starts_with("error: ") && stderr.contains(word),
                "{word:?}: {stderr}"
            );
        }
        std::fs::write(&path, good).unwrap();
    }
    let sliding = ["simulate", "--robot", "scara.toml", "--joint", "3"];
    let assert = quell(folder.path(), &sliding).assert().code(2);
    let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(stderr.contains("--joint 3: it slides"), "{stderr}");
}

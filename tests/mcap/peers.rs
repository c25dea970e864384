//! Independent readers and writers, in Python: skipped where they cannot be installed.

use super::{MS, ORIGIN, SAMPLES, modes, save, values, whole};
use quell::recording::{McapFile, Recording, Role};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// The output of a script of `tests/ros2`.
fn python(script: &str, argument: &Path) -> Option<Vec<u8>> {
    let script = [script.as_ref(), argument.as_os_str()];
    super::python::python("ros2", "requirements.txt", &script)
}

/// A number as the other readers print it, so that no digit is lost on the way.
fn bits(number: f64) -> i64 {
    i64::from_le_bytes(number.to_le_bytes())
}

#[test]
fn other_readers_read_every_message() {
    let folder = TempDir::new().unwrap();
    let path = save(&folder, whole());
    let Some(read) = python("read.py", &path) else {
        return;
    };
    let read: Value = serde_json::from_slice(&read).unwrap();
    let file = McapFile::open(&path).unwrap();
    for reader in ["rosbags", "mcap"] {
        let rows = read[reader].as_array().unwrap();
        let of = |topic: &str| {
            rows.iter()
                .filter(|row| row[0] == *topic)
                .collect::<Vec<_>>()
        };
        assert_eq!(file.topics().len(), 3 + SAMPLES.len());
        for topic in file.topics() {
            assert_eq!(
                of(&topic.name).len(),
                topic.messages,
                "{reader}: {}",
                topic.name
            );
        }
        for (tick, row) in (0..).zip(of("/quell/hip/command")) {
            let (t, now) = (tick as f64 / 1e3, ORIGIN + tick * MS);
            let values = serde_json::json!([bits(t.sin()), bits(t.cos())]);
            assert_eq!((&row[1], &row[3]), (&now.into(), &now.into()), "{reader}");
            assert_eq!((&row[4][0], &row[5]), (&"hip".into(), &values), "{reader}");
        }
        for (t, row) in (0..).zip(of("/quell/hip/modes")) {
            let values = serde_json::json!(modes(f64::from(t)).map(bits));
            assert_eq!(row[5], values, "{reader}");
        }
        for (index, (role, count)) in SAMPLES.into_iter().enumerate() {
            let topic = match role {
                Role::MotorPosition => "/joint_states".to_owned(),
                _ => format!("/quell/hip/{role}"),
            };
            for (row, sample) in of(&topic).into_iter().zip(0..) {
                let tick = 4 * sample + index as i64 % 4;
                assert_eq!(row[1], ORIGIN + tick * MS, "{reader}: {topic}");
                let stamp = ORIGIN + (tick - 2) * MS;
                let told = [&row[2], &row[3]]
                    .into_iter()
                    .filter(|v| **v != 0 && !v.is_null());
                for time in told {
                    assert_eq!(*time, stamp, "{reader}: {topic}");
                }
                let values = values(tick, role, count).into_iter().map(bits);
                let values = serde_json::json!(values.collect::<Vec<_>>());
                assert_eq!(row[5], values, "{reader}: {topic}");
            }
        }
    }
}

/// Roles and units are borrowed for what the fields hold; the test is of the fields.
const OTHERS: &str = r#"
name = "other writers"
[[channel]]
role = "tip_acceleration"
topic = "/imu"
fields = ["linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z"]
unit = "m/s^2"
[[channel]]
role = "deformation"
topic = "/array"
field = "data[1]"
unit = "rad"
[[channel]]
role = "motor_position"
topic = "/arm"
field = "angles[knee]"
unit = "rad"
rows = [10, 20]
[[channel]]
role = "link_position"
topic = "/arm"
field = "axes[2].angle"
time = "log_time"
unit = "deg"
[[channel]]
role = "tip_position"
topic = "/arm"
fields = ["tip[0]", "counters[1]", "axes[1].counts"]
unit = "m"
"#;

#[test]
fn the_files_of_other_writers_are_read_by_their_definitions() {
    let folder = TempDir::new().unwrap();
    if python("write.py", folder.path()).is_none() {
        return;
    }
    for compression in ["none", "lz4", "zstd"] {
        let file = format!("file = \"{compression}.mcap\"\nrole");
        let manifest = folder.path().join(format!("{compression}.toml"));
        std::fs::write(&manifest, OTHERS.replace("role", &file)).unwrap();
        let recording = Recording::from_path(&manifest).unwrap();
        let channel = |role| recording.channel(role).unwrap();
        let tip = channel(Role::TipAcceleration);
        let arm = channel(Role::TipPosition);
        let link = channel(Role::LinkPosition);
        for k in 0..500 {
            let t = k as f64;
            // Stamps are 3 ms before the log, from which time counts.
            assert_eq!(tip.time[k], (10 * k as i64 - 3) as f64 / 1e3);
            assert_eq!(tip.columns[2][k], 2.0 * (t + 0.5));
            assert_eq!(channel(Role::Deformation).columns[0][k], -t / 8.0);
            assert_eq!(link.time[k], t / 1e2);
            assert_eq!(
                link.columns[0][k],
                (t + 2.0) / 4.0 * std::f64::consts::PI / 180.0
            );
            assert_eq!(arm.columns[0][k], t / 2.0);
            assert_eq!(arm.columns[1][k], 2_f64.powi(40) + t);
            assert_eq!(arm.columns[2][k], 1.0 - t);
        }
        let knee: Vec<_> = (10..20).map(|k| -f64::from(k) / 16.0).collect();
        assert_eq!(
            channel(Role::MotorPosition).columns,
            [knee],
            "{compression}"
        );
    }
    topics_without_a_role(folder.path());
}

/// What the names of topics do not say is named, with the lines that read it.
fn topics_without_a_role(folder: &Path) {
    let mut quell = assert_cmd::Command::cargo_bin("quell").unwrap();
    let inspected = quell.arg("inspect").arg(folder.join("states.mcap"));
    let told = inspected.assert().success().get_output().stdout.clone();
    let told = String::from_utf8(told).unwrap();
    assert!(
        told.contains("Not read, as the name does not say what is measured: /link_states\n"),
        "{told}"
    );
    assert!(
        told.ends_with("Then: quell identify 'recording.toml#hip'\n"),
        "{told}"
    );
    let from = told.find("    [[channel]]").expect("the lines");
    let lines = told[from..].split("\n\n").next().expect("the lines");
    let name = "name = \"states\"\n";
    std::fs::write(folder.join("states.toml"), format!("{name}{lines}\n")).unwrap();
    let recording = Recording::from_path(folder.join("states.toml#hip")).unwrap();
    let link = recording.channel(Role::LinkPosition).unwrap();
    assert_eq!(link.columns[0][8], 0.75);
}

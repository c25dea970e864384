//! Recordings as MCAP files: what is written is read back, by others too, and what is damaged is refused.

mod damage;
mod peers;
#[path = "../absent/python.rs"]
mod python;
#[path = "../absent/skipped.rs"]
mod skipped;

use assert_cmd::Command;
use quell::recording::{McapWriter, Recording, RecordingError, Role};
use serde_json::Value;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;

/// 2023-11-14 22:13:20 UTC, ns.
const ORIGIN: i64 = 1_700_000_000_000_000_000;
/// A millisecond, ns.
const MS: i64 = 1_000_000;

/// Roles and their columns: at least one for each type of message that is written.
const SAMPLES: [(Role, usize); 7] = [
    (Role::MotorPosition, 1),
    (Role::LinkPosition, 1),
    (Role::TipPosition, 3),
    (Role::LinkVelocity, 1),
    (Role::LinkAcceleration, 1),
    (Role::TipAcceleration, 3),
    (Role::Torque, 1),
];

fn values(tick: i64, role: Role, count: usize) -> Vec<f64> {
    let value =
        |column: usize| (tick as f64 * 0.01 + column as f64).sin() / (1.0 + role as usize as f64);
    (0..count).map(value).collect()
}

/// Frequencies and damping ratios of two modes.
fn modes(t: f64) -> [f64; 4] {
    [8.0 + t, 0.05, 19.0 - t, 0.03]
}

/// Commands at 1 kHz and each sensor at 250 Hz with its own phase, of `ticks` milliseconds.
fn write(writer: &mut McapWriter, ticks: i64) -> Result<(), RecordingError> {
    for tick in 0..ticks {
        let t = tick as f64 / 1e3;
        writer.write_command(t, "hip", t.sin(), t.cos(), -t.sin())?;
        for (index, (role, count)) in SAMPLES.into_iter().enumerate() {
            if tick % 4 == index as i64 % 4 {
                // The bus delays by 2 ms what the sensor stamped.
                let stamp = (tick - 2) as f64 / 1e3;
                writer.write_sample(t, "hip", role, stamp, &values(tick, role, count))?;
            }
        }
        if tick % 1000 == 0 {
            let numbers = modes(t);
            writer.write_numbers(t, "hip", "modes", &[("mode", 2), ("f,xi", 2)], &numbers)?;
        }
    }
    Ok(())
}

/// A writer of a new file for these joints, from [`ORIGIN`] on.
fn created(path: &Path, joints: &[&str]) -> McapWriter {
    let file = File::create(path).unwrap();
    McapWriter::on(Box::new(file), path, joints, ORIGIN).unwrap()
}

/// A finished file of 3 s, made once.
fn whole() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let folder = TempDir::new().unwrap();
        let path = folder.path().join("run.mcap");
        let mut writer = created(&path, &["hip"]);
        write(&mut writer, 3000).unwrap();
        writer.finish().unwrap();
        std::fs::read(path).unwrap()
    })
}

fn save(folder: &TempDir, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join("run.mcap");
    std::fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn what_is_written_is_read_back_to_the_bit() {
    let folder = TempDir::new().unwrap();
    let recording = Recording::from_path(save(&folder, whole())).unwrap();
    assert_eq!(recording.name, "run");
    assert_eq!(recording.channels.len(), 1 + SAMPLES.len());
    let command = recording.channel(Role::CommandPosition).unwrap();
    let times: Vec<_> = (0..3000).map(|tick| f64::from(tick) / 1e3).collect();
    assert_eq!(command.time, times);
    assert_eq!(
        command.columns[0],
        times.iter().map(|t| t.sin()).collect::<Vec<_>>()
    );
    for (index, (role, count)) in SAMPLES.into_iter().enumerate() {
        let channel = recording.channel(role).unwrap();
        let ticks: Vec<i64> = (0..3000)
            .filter(|tick| tick % 4 == index as i64 % 4)
            .collect();
        let times: Vec<_> = ticks.iter().map(|tick| (tick - 2) as f64 / 1e3).collect();
        assert_eq!(channel.time, times, "{role}");
        assert!(channel.has_usual_unit(), "{role}");
        for (row, tick) in ticks.iter().enumerate() {
            let columns: Vec<_> = channel.columns.iter().map(|column| column[row]).collect();
            assert_eq!(columns, values(*tick, role, count), "{role}");
        }
    }
}

/// What is known of a joint is no channel of its recording, and is read by name.
#[test]
fn numbers_are_read_by_their_definition() {
    let folder = TempDir::new().unwrap();
    save(&folder, whole());
    let entry = "[[channel]]\nrole = \"deformation\"\nfile = \"run.mcap\"\nunit = \"rad\"\n\
                 topic = \"/quell/hip/modes\"\nfield = \"data[2]\"\n";
    let path = folder.path().join("recording.toml");
    std::fs::write(&path, format!("name = \"modes\"\n{entry}")).unwrap();
    let recording = Recording::from_path(&path).unwrap();
    let second = &recording.channel(Role::Deformation).unwrap().columns[0];
    assert_eq!(*second, [0.0, 1.0, 2.0].map(|t| modes(t)[2]));
    let mut writer = created(&folder.path().join("bad.mcap"), &["hip"]);
    let refused = writer.write_numbers(0.0, "hip", "modes", &[("mode", 2)], &[1.0]);
    let error = refused.expect_err("one number is not two").to_string();
    assert!(error.contains("modes"), "{error}");
}

#[test]
fn what_is_asked_for_in_vain_is_told_with_what_is_there() {
    let folder = TempDir::new().unwrap();
    save(&folder, whole());
    let entry = "name = \"x\"\n[[channel]]\nrole = \"motor_position\"\nfile = \"run.mcap\"\nunit = \"rad\"\n";
    let (states, column) = ("topic = \"/joint_states\"\n", "column = \"q\"\n");
    let cases = [
        (
            "field = \"position[0]\"\n".into(),
            "recording.toml:3: topic: an MCAP file needs topic",
        ),
        (format!("{states}{column}"), "field or fields"),
        (states.into(), "give either field"),
        (
            "topic = \"/joint\"\nfield = \"x\"\n".into(),
            "no such topic; the topics are: /quell/hip/command",
        ),
        (
            format!("{states}field = \"positon[0]\"\n"),
            "there is no field \"positon\"; its numbers are: header.stamp.sec",
        ),
        (
            format!("{states}field = \"position\"\n"),
            "say which, as in position[0]",
        ),
        (format!("{states}field = \"position[1]\"\n"), "byte"),
        (
            format!("{states}field = \"position[knee]\"\n"),
            "the names are: hip",
        ),
        (
            format!("{states}field = \"header.frame_id\"\n"),
            "it is no number",
        ),
        (
            format!("{states}field = \"header.stamp.sec.x\"\n"),
            "there is nothing in a number",
        ),
        (
            format!("{states}field = \"effort[0]\"\n"),
            "topic \"/joint_states\": field \"effort[0]\": it has 0 elements",
        ),
        (
            format!("{states}field = \"position[0]\"\ntime = \"stamp\"\n"),
            "there is no field \"stamp\"",
        ),
    ];
    for (lines, word) in cases {
        let path = folder.path().join("recording.toml");
        std::fs::write(&path, format!("{entry}{lines}")).unwrap();
        let error = Recording::from_path(&path).unwrap_err().to_string();
        assert!(error.contains(word), "{lines}: {error}");
    }
}

#[test]
fn what_cannot_be_written_is_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("run.mcap");
    let mut writer = created(&path, &["hip"]);
    let position = Role::MotorPosition;
    let results = [
        writer.write_sample(0.0, "knee", position, 0.0, &[1.0]),
        writer.write_sample(0.0, "hip", position, 0.0, &[f64::NAN]),
        writer.write_sample(0.0, "hip", position, 0.0, &[1.0, 2.0, 3.0]),
        writer.write_sample(0.0, "hip", position, -2e9, &[1.0]),
        writer.write_command(f64::INFINITY, "hip", 0.0, 0.0, 0.0),
    ];
    let words = ["\"knee\"", "NaN", "3 values", "1970", "inf"];
    for (result, word) in results.into_iter().zip(words) {
        let error = result.unwrap_err().to_string();
        assert!(
            error.contains("run.mcap") && error.contains(word),
            "{error}"
        );
    }
    // A clock of its own is brought onto the file's.
    for tick in 0..100 {
        let t = f64::from(tick) / 1e2;
        writer.write_command(t, "hip", 0.0, 0.0, 0.0).unwrap();
        writer
            .write_sample(t, "hip", position, t + 12_345.0, &[t])
            .unwrap();
    }
    writer.finish().unwrap();
    let recording = Recording::from_path(&path).unwrap();
    assert_eq!(recording.channel(position).unwrap().time[50], 0.5);
}

#[test]
fn inspect_lists_topics_and_roles() {
    let folder = TempDir::new().unwrap();
    let path = save(&folder, &whole()[..whole().len() / 2]);
    let inspect = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("quell").unwrap();
        let assert = command
            .arg("inspect")
            .arg(&path)
            .args(arguments)
            .assert()
            .success();
        String::from_utf8(assert.get_output().stdout.clone()).unwrap()
    };
    let text = inspect(&[]);
    for word in [
        "/joint_states",
        "sensor_msgs/msg/JointState",
        "position[hip]",
        "is cut",
        "What looks wrong",
    ] {
        assert!(text.contains(word), "no {word} in {text}");
    }
    let all: Value = serde_json::from_str(&inspect(&["--json"])).unwrap();
    assert_eq!(all["joints"][0]["joint"], "hip");
    assert_eq!(
        all["joints"][0]["roles"].as_array().unwrap().len(),
        1 + SAMPLES.len()
    );
    assert_eq!(all["channels"].as_array().unwrap().len(), 1 + SAMPLES.len());
    assert_eq!(all["cut"]["of"], whole().len() / 2);
    let states = &all["topics"][2];
    assert_eq!(states["topic"], "/joint_states");
    assert_eq!(states["fields"][2], "position[]");

    let mut writer = created(&path, &["hip", "knee"]);
    for joint in ["hip", "knee"] {
        writer
            .write_sample(0.0, joint, Role::Deformation, 0.0, &[0.1])
            .unwrap();
    }
    writer.finish().unwrap();
    assert!(inspect(&[]).contains("run.mcap#hip"));
    let error = Recording::from_path(&path).unwrap_err().to_string();
    assert!(error.contains("hip, knee"), "{error}");
    let knee = format!("{}#knee", path.display());
    assert_eq!(Recording::from_path(knee).unwrap().channels.len(), 1);
}

/// Runs a verb in a folder; what it prints.
fn quell(folder: &TempDir, arguments: &[&str]) -> String {
    let mut command = Command::cargo_bin("quell").unwrap();
    let assert = command
        .current_dir(folder)
        .args(arguments)
        .assert()
        .success();
    String::from_utf8(assert.get_output().stdout.clone()).unwrap()
}

#[test]
fn every_verb_takes_an_mcap_file_as_it_takes_a_manifest() {
    let folder = TempDir::new().unwrap();
    quell(
        &folder,
        &[
            "simulate", "--target", "30", "--target", "0", "--out", "arm",
        ],
    );
    let recording = Recording::from_path(folder.path().join("arm")).unwrap();
    let path = folder.path().join("arm.mcap");
    let mut writer = created(&path, &["hip"]);
    for channel in &recording.channels {
        for (sample, t) in channel.time.iter().enumerate() {
            let row: Vec<_> = channel
                .columns
                .iter()
                .map(|column| column[sample])
                .collect();
            writer
                .write_sample(*t, "hip", channel.role, *t, &row)
                .unwrap();
        }
    }
    writer.finish().unwrap();
    let model = "arm/model.toml";
    for (verb, lines) in [
        (
            &["identify", "IT", "--model", model][..],
            &["likelihood", "batch_fit", "clock"][..],
        ),
        (&["score", model, "IT"], &["rms"]),
        (&["simulate", model, "IT", "--out", "p.csv"], &["rms"]),
        (&["simulate", "--command", "IT", "--out", "again"], &["1 "]),
    ] {
        // Stamps are rounded to a nanosecond, which no digit that is printed shows.
        let [folder_says, file_says] = ["arm", "arm.mcap"].map(|name| {
            let arguments = verb.iter().map(|word| word.replace("IT", name));
            let arguments: Vec<String> = arguments.collect();
            let text = quell(
                &folder,
                &arguments.iter().map(String::as_str).collect::<Vec<_>>(),
            );
            let told = |line: &&str| lines.iter().any(|word| line.contains(word));
            text.lines()
                .filter(told)
                .map(str::to_owned)
                .collect::<Vec<_>>()
        });
        assert_eq!(folder_says, file_says, "{verb:?}");
        assert!(file_says.len() >= lines.len(), "{verb:?}: {file_says:?}");
    }
}

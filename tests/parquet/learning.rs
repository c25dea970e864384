//! A data set for learning as LeRobot writes it: lists of states and actions, episodes, 30 samples a second.

use super::quell;
use super::servo::{RATE, SAMPLES, episodes, names_the_delay, servo};
use super::written::Column::{Float, Int64, Lists, Text};
use super::written::{List, written};
use parquet::basic::Compression;
use quell::recording::Recording;
use tempfile::TempDir;

/// The delay of a servo's drive is found in the second of two episodes, with the manifest that Quell proposes.
#[test]
fn an_episode_of_a_data_set_is_diagnosed() {
    let folder = TempDir::new().unwrap();
    let here = folder.path();
    let rows = episodes();
    let list = |from: usize| -> Vec<List> {
        let both = |row: &[f32; 4]| Some(vec![Some(row[from]), Some(row[from + 1])]);
        rows.iter().map(both).collect()
    };
    let frame = |row: usize| (row % SAMPLES) as i64;
    let counts = 0..rows.len();
    let columns = [
        ("observation.state", Lists(list(0))),
        ("action", Lists(list(2))),
        (
            "timestamp",
            Float(
                counts
                    .clone()
                    .map(|row| Some((frame(row) as f64 / RATE) as f32))
                    .collect(),
            ),
        ),
        (
            "frame_index",
            Int64(counts.clone().map(|row| Some(frame(row))).collect()),
        ),
        (
            "episode_index",
            Int64(
                counts
                    .clone()
                    .map(|row| Some((row / SAMPLES) as i64))
                    .collect(),
            ),
        ),
        ("task", Text(vec![Some("push the cube"); rows.len()])),
    ];
    let file = written(&columns, Compression::SNAPPY, 500);
    std::fs::write(here.join("file-000.parquet"), file).unwrap();
    let (_, out, err) = quell(here, &["inspect", "file-000.parquet"]);
    assert!(
        out.contains("only = { \"episode_index\" = \"0\" }"),
        "{out}{err}"
    );
    let second = here.join("file-000_1.toml");
    let manifest = std::fs::read_to_string(&second).unwrap();
    // Nulls and text columns are not mentioned; the user gives the units.
    assert!(
        !manifest.contains("missing") && !manifest.contains("task"),
        "{manifest}"
    );
    assert_eq!(manifest.matches("unit = \"raw\"").count(), 4, "{manifest}");
    std::fs::write(&second, manifest.replace("\"raw\"", "\"rad\"")).unwrap();
    let joint = format!("{}#1", second.display());
    let read = Recording::from_path(&joint).unwrap();
    for channel in &read.channels {
        assert_eq!(channel.time.len(), SAMPLES);
        let state = channel.role.name() == "motor_position";
        let column = if state { 1 } else { 3 };
        let own = rows[SAMPLES..].iter().map(|row| f64::from(row[column]));
        assert!(
            own.eq(channel.columns[0].iter().copied()),
            "{}",
            channel.role
        );
    }

    std::fs::write(here.join("servo.toml"), servo()).unwrap();
    let asked = [
        "diagnose",
        "--model",
        "servo.toml",
        &joint,
        "--out",
        "told",
        "--json",
    ];
    let (_, out, err) = quell(here, &asked);
    let told: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{err}"));
    names_the_delay(&told);
}

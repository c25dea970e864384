//! Data sets for learning in the form of LeRobot's, as CSV: lists of states and actions, episodes, 30 samples a second.

#[path = "episodes/servo.rs"]
mod servo;

use assert_cmd::Command;
use servo::{RATE, SAMPLES, names_the_delay};
use std::path::Path;
use tempfile::TempDir;

/// Writes two episodes: an element of a list for each joint, stamps that begin again, and columns that count.
fn data_set(file: &Path) {
    let mut text = String::from(
        "observation.state[0],observation.state[1],action[0],action[1],timestamp,frame_index,episode_index\n",
    );
    for (row, [first, second, one, other]) in servo::episodes().iter().enumerate() {
        let (episode, k) = (row / SAMPLES, row % SAMPLES);
        let time = k as f64 / RATE;
        text += &format!("{first},{second},{one},{other},{time},{k},{episode}\n");
    }
    std::fs::write(file, text).unwrap();
}

fn quell(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = Command::cargo_bin("quell").unwrap();
    command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// Friction and delay are told at 30 samples a second; a mode that is faster than these show is refused with the rate.
#[test]
fn episodes_are_diagnosed_or_refused_with_the_rate_that_it_takes() {
    let folder = TempDir::new().unwrap();
    let here = folder.path();
    data_set(&here.join("file-000.csv"));
    let told = quell(here, &["inspect", "file-000.csv"]);
    let text = String::from_utf8(told.stdout).unwrap();
    assert!(
        text.contains("only = { \"episode_index\" = \"0\" }"),
        "{text}"
    );
    assert!(text.contains("file-000_1.toml"), "{text}");
    // The units are the user's: nothing in the file says them.
    let manifest = std::fs::read_to_string(here.join("recording.toml")).unwrap();
    assert_eq!(manifest.matches("unit = \"raw\"").count(), 4, "{manifest}");
    let corrected = manifest.replace("\"raw\"", "\"rad\"");
    std::fs::write(here.join("recording.toml"), &corrected).unwrap();

    std::fs::write(here.join("servo.toml"), servo::servo()).unwrap();
    let diagnosis = |joint: &str| -> serde_json::Value {
        let recording = format!("recording.toml#{joint}");
        let out = format!("joint-{joint}");
        let told = quell(
            here,
            &[
                "diagnose",
                "--model",
                "servo.toml",
                &recording,
                "--out",
                &out,
                "--json",
            ],
        );
        serde_json::from_slice(&told.stdout).unwrap_or_else(|_| panic!("{told:?}"))
    };
    let friction = diagnosis("0");
    let named: Vec<&str> = friction["candidates"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|one| one["effects"].as_str())
        .collect();
    assert!(
        friction["summary"]
            .as_str()
            .unwrap()
            .contains("Coulomb friction"),
        "{named:?} {}",
        friction["summary"]
    );
    names_the_delay(&diagnosis("1"));

    let elastic = corrected.replace("\"motor_position\"", "\"link_position\"");
    std::fs::write(here.join("elastic.toml"), elastic).unwrap();
    std::fs::write(
        here.join("fast.toml"),
        "kind = \"flexible_joint\"\nnatural_frequency_hz = 22\ndamping_ratio = 0.03\n",
    )
    .unwrap();
    let refused = quell(
        here,
        &["diagnose", "--model", "fast.toml", "elastic.toml#0"],
    );
    let words = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2));
    assert!(words.contains("has 30 samples a second, and shows a mode of 22 Hz at 8 Hz: record it at more than 44 Hz"), "{words}");
}

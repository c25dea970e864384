//! Data sets for learning in the form of LeRobot's, as CSV: lists of states and actions, episodes, 30 samples a second.

use assert_cmd::Command;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::f64::consts::TAU;
use std::path::Path;
use tempfile::TempDir;

/// Samples a second, and of an episode.
const RATE: f64 = 30.0;
const SAMPLES: usize = 600;
/// Gains of the servos: position 1/s, velocity kg.m^2/s; their inertia is 1.
const GAINS: [f64; 2] = [12.0, 40.0];
const NOISE: f64 = 2e-4;
/// How late the second joint's drive is, s; friction of the first one's.
const LATE: f64 = 0.08;
const FRICTION: f64 = 3.0;

/// Command of a joint, rad: what a hand shows it, held over a sample.
fn command(joint: usize, time: f64) -> f64 {
    let held = (time.max(0.0) * RATE + 1e-9).floor() / RATE;
    let parts = [(0.30, 0.21), (0.22, 0.37), (0.13, 0.83)];
    let each = parts.iter().map(|(size, hertz)| {
        size * (1.0 - (TAU * hertz * held * (1.0 + 0.1 * joint as f64)).cos())
    });
    each.sum()
}

/// State of a joint: a servo with dry friction, or with a drive that is late.
fn states(joint: usize, random: &mut ChaCha8Rng) -> Vec<f32> {
    let (fine, [position_gain, velocity_gain]) = (100, GAINS);
    let dt = 1.0 / (RATE * fine as f64);
    let (friction, late) = [(FRICTION, 0.0), (0.0, LATE)][joint];
    let (mut x, mut v, mut seen) = (0.0_f64, 0.0_f64, Vec::new());
    for k in 0..SAMPLES {
        seen.push((x + NOISE * random.sample::<f64, _>(StandardNormal)) as f32);
        for step in 0..fine {
            let wanted = command(joint, k as f64 / RATE + step as f64 * dt - late);
            let force = velocity_gain * (position_gain * (wanted - x) - v);
            let sticks = v == 0.0 && force.abs() <= friction;
            let rubbing = friction * if v == 0.0 { force.signum() } else { v.signum() };
            let next = v + dt * if sticks { 0.0 } else { force - rubbing };
            // Friction brakes; it does not turn a motion round.
            v = if friction > 0.0 && next * v < 0.0 {
                0.0
            } else {
                next
            };
            x += dt * v;
        }
    }
    seen
}

/// Writes two episodes: an element of a list for each joint, stamps that begin again, and columns that count.
fn data_set(file: &Path) {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut text = String::from(
        "observation.state[0],observation.state[1],action[0],action[1],timestamp,frame_index,episode_index\n",
    );
    for episode in 0..2 {
        let [first, second] = [0, 1].map(|joint| states(joint, &mut random));
        for k in 0..SAMPLES {
            let time = k as f64 / RATE;
            let [one, other] = [0, 1].map(|joint| command(joint, time) as f32);
            text += &format!(
                "{},{},{one},{other},{time},{k},{episode}\n",
                first[k], second[k]
            );
        }
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

    let [position, velocity] = GAINS;
    let servo = format!(
        "kind = \"rigid_axis\"\ninput_hold = \"zero_order\"\nmass = {{ value = 1.0, fixed = true }}\nviscous = 0.0\n\
         position_gain = {position}\nvelocity_gain = {velocity}\n"
    );
    std::fs::write(here.join("servo.toml"), servo).unwrap();
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
    let late = diagnosis("1");
    let finding = &late["findings"][0];
    assert!(
        ["drive_delay", "sensor_delay"].contains(&finding["effect"].as_str().unwrap()),
        "{finding}"
    );
    let delay = finding["parameters"][0]["value"].as_f64().unwrap();
    assert!((delay / LATE - 1.0).abs() < 0.02, "{finding}");

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

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

/// A link on a servo at 30 samples a second: states of the servo and of the link, rad, for the same commands.
/// Both are of second order: the link rings on the servo if it has a mode (Hz, damping ratio).
fn linked([hertz, damping]: [f64; 2], link: Option<[f64; 2]>) -> Vec<[f64; 3]> {
    let (fine, pi) = (100, std::f64::consts::PI);
    let dt = 1.0 / (RATE * fine as f64);
    let reached = |time: f64, [at, takes, by]: [f64; 3]| {
        let s = ((time - at) / takes).clamp(0.0, 1.0);
        by * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)
    };
    let moves = [
        [1.0, 0.4, 0.5],
        [3.5, 0.7, -0.8],
        [7.0, 0.5, 0.4],
        [11.0, 1.0, 0.6],
        [15.0, 0.4, -0.7],
    ];
    let (w, [own, xi]) = (2.0 * pi * hertz, link.unwrap_or([1.0, 1.0]));
    let own = 2.0 * pi * own;
    let [mut x, mut v, mut d, mut u] = [0.0; 4];
    let mut rows = Vec::new();
    for k in 0..SAMPLES {
        let time = k as f64 / RATE;
        let command: f64 = moves.iter().map(|one| reached(time, *one)).sum();
        // Encoders of 12 bits.
        let seen = |angle: f64| (angle * 4096.0 / (2.0 * pi)).round() * 2.0 * pi / 4096.0;
        rows.push([command, seen(x), seen(x + d)]);
        for _ in 0..fine {
            let a = w * w * (command - x) - 2.0 * damping * w * v;
            u += dt * (-a * f64::from(link.is_some()) - 2.0 * xi * own * u - own * own * d);
            d += dt * u;
            v += dt * a;
            x += dt * v;
        }
    }
    rows
}

/// What `quell identify` says of two columns of such a recording: the document, the text, and the model; the error where it
/// refuses it.
fn identified(
    columns: [&str; 2],
    rows: impl Iterator<Item = [f64; 2]>,
) -> Result<[String; 3], String> {
    let folder = TempDir::new().unwrap();
    let mut text = format!("time_s,{},{}\n", columns[0], columns[1]);
    for (k, [first, second]) in rows.enumerate() {
        text += &format!("{},{first},{second}\n", k as f64 / RATE);
    }
    std::fs::write(folder.path().join("run.csv"), text).unwrap();
    let run = |more: &[&str]| {
        let told = quell(folder.path(), &[&["identify", "run.csv"], more].concat());
        match told.status.success() {
            true => Ok(String::from_utf8(told.stdout).unwrap()),
            false => Err(String::from_utf8(told.stderr).unwrap()),
        }
    };
    let [document, text] = [run(&["--json"])?, run(&[])?];
    let model = std::fs::read_to_string(folder.path().join("out/model.toml")).unwrap();
    Ok([document, text, model])
}

/// The response of a servo is no mode of the structure, and gets no shaper. With the command as the motor side that is told
/// where the mode stands, with the frequencies that 30 samples a second show.
#[test]
fn a_servo_that_follows_its_command_is_not_taken_for_a_mode_of_the_arm() {
    let json = |text: &str| -> serde_json::Value { serde_json::from_str(text).unwrap() };
    let columns = ["command_position_rad", "link_position_rad"];
    for (servo, link, rings) in [
        ([1.5, 0.7], None, false),
        ([3.0, 1.1], None, false),
        ([2.5, 0.15], None, true),
        ([3.0, 0.7], Some([5.0, 0.02]), true),
    ] {
        let rows = linked(servo, link);
        let told = identified(columns, rows.iter().map(|row| [row[0], row[2]]));
        let [document, text, model] = match told {
            Ok(told) => told,
            Err(error) => {
                // Of a link behind a servo that does not ring, this may be all that 12 bits show.
                assert!(!rings || link.is_some(), "{error}");
                assert!(
                    error.contains("how the servo follows its command"),
                    "{error}"
                );
                continue;
            }
        };
        assert!(rings || link.is_some(), "{text}");
        let document = json(&document);
        let best = &document["recommended"];
        assert_eq!(best["includes_servo"], true, "{best}");
        let words = "This is a mode of servo and link together";
        let at = text.find("Recommended: ").unwrap();
        assert!(text[at..].contains(words), "{text}");
        assert!(model.contains(words), "{model}");
        assert!(
            text.contains("to 6.00 Hz. At 30.0 samples a second none above 15.0 Hz can be seen."),
            "{text}"
        );
        assert!((document["nyquist_hz"].as_f64().unwrap() - 15.0).abs() < 1e-6);
    }
    // With the motor side's own sensor the servo is no part of the mode.
    let rows = linked([3.0, 0.7], Some([4.0, 0.03]));
    let columns = ["motor_position_rad", "link_position_rad"];
    let told = identified(columns, rows.iter().map(|row| [row[1], row[2]]));
    let [document, text, model] = told.unwrap();
    let best = &json(&document)["recommended"];
    assert_eq!(best["includes_servo"], false, "{best}");
    assert!(!(text + &model).contains("servo"), "{best}");
    let mode = &json(&document)["mode"];
    assert!(
        (mode["frequency_hz"].as_f64().unwrap() - 4.0).abs() < 0.1,
        "{mode}"
    );
}

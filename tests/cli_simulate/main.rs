//! `quell simulate` as a user types it: what it writes, what it says, and what it refuses.

mod command;
mod mode_fit;
mod robots;

use assert_cmd::Command;
use mode_fit::fitted_mode;
use quell::recording::{Recording, Role};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

fn quell(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("quell").unwrap();
    command.current_dir(folder).args(arguments);
    command
}

fn simulate(folder: &Path, arguments: &str) -> Value {
    let assert = quell(folder, &["simulate", "--json"])
        .args(arguments.split_whitespace())
        .assert()
        .success();
    serde_json::from_slice(&assert.get_output().stdout).unwrap()
}

fn residual(document: &Value, leg: usize) -> f64 {
    document["moves"][leg]["residual_mm"].as_f64().unwrap()
}

#[test]
fn without_arguments_the_embedded_arm_makes_its_move() {
    let folder = TempDir::new().unwrap();
    let assert = quell(folder.path(), &["simulate"]).assert().success();
    let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    for word in [
        "RX-170B",
        "8.120 Hz",
        "unshaped",
        "30.0000",
        "0.7376",
        "out/recording.toml",
    ] {
        assert!(text.contains(word), "no {word:?} in {text}");
    }
    // The paper's Fig. 4: the unshaped move leaves 0.74 mm.
    let document = simulate(folder.path(), "");
    assert!((residual(&document, 0) - 0.74).abs() < 0.005, "{document}");
    let model = std::fs::read_to_string(folder.path().join("out/model.toml")).unwrap();
    let model: toml::Table = model.parse().unwrap();
    assert_eq!(model["kind"].as_str(), Some("flexible_joint"));
    assert_eq!(model["natural_frequency_hz"].as_float(), Some(8.12));
    assert_eq!(model["damping_ratio"].as_float(), Some(0.084));
    assert!(model["lever_arm_m"].as_float() > Some(1.8));

    let inspected = quell(folder.path(), &["inspect", "out", "--json"])
        .assert()
        .success();
    let inspected: Value = serde_json::from_slice(&inspected.get_output().stdout).unwrap();
    let channels = inspected["channels"].as_array().unwrap();
    let roles: Vec<_> = channels.iter().map(|channel| &channel["role"]).collect();
    assert_eq!(
        roles,
        ["command_position", "motor_position", "tip_position"]
    );
    for channel in channels {
        assert_eq!(
            channel["remarks"].as_array().map(Vec::len),
            Some(0),
            "{channel}"
        );
    }
    assert!((channels[1]["rate_hz"].as_f64().unwrap() - 250.0).abs() < 1e-6);
    assert!((channels[2]["rate_hz"].as_f64().unwrap() - 333.0).abs() < 1e-6);
    // 10 um on each coordinate; the estimate's own spread at 859 samples is below 10 %.
    let noise = channels[2]["columns"][0]["noise_std"].as_f64().unwrap();
    assert!((noise - 10e-6).abs() < 1.5e-6, "{noise}");
}

#[test]
fn val_the_free_decay_has_the_mode_that_was_asked_for() {
    for (arguments, frequency, damping_ratio) in [
        ("", 8.12, 0.084),
        ("--mode 5.3,0.02 --dwell 3", 5.3, 0.02),
        ("--damping to_ground --seed 4", 8.12, 0.084),
    ] {
        let folder = TempDir::new().unwrap();
        let document = simulate(folder.path(), arguments);
        let from = document["moves"][0]["motor_end_s"].as_f64().unwrap();
        let recording = Recording::from_path(folder.path().join("out")).unwrap();
        let (fitted, damping) = fitted_mode(&recording, from);
        // The Cramer-Rao bound over a whole decay from 0.74 mm at 10 um is 0.1 % and 0.001; five
        // of them.
        assert!(
            (fitted / frequency - 1.0).abs() < 0.005,
            "{fitted} Hz {arguments:?}"
        );
        assert!(
            (damping - damping_ratio).abs() < 0.005,
            "{damping} {arguments:?}"
        );
        assert_eq!(
            document["modes"][0]["frequency_hz"].as_f64(),
            Some(frequency)
        );
    }
}

#[test]
fn the_shaper_works_as_well_as_its_belief() {
    let folder = TempDir::new().unwrap();
    let unshaped = residual(&simulate(folder.path(), ""), 0);
    let right = simulate(folder.path(), "--shaper zvd");
    // What the servo still forces once the motor is within a step: see the tests of `quell compare`.
    assert!(residual(&right, 0) < 0.041, "{right}");
    // One damped period of delay, rounded up to a tick of 4 ms.
    let period = 1.0 / (8.12 * (1.0 - 0.084_f64.powi(2)).sqrt());
    let delay = right["added_delay_s"].as_f64().unwrap();
    assert!((delay - period).abs() < 0.008, "{delay}");
    let wrong = simulate(folder.path(), "--shaper zvd --belief 10.15,0.084");
    let ratio = residual(&wrong, 0) / unshaped;
    // ZVD designed 25 % above the mode leaves 10 %; half a period of decay (23 %) lies between the
    // instants from which the two peaks are counted.
    assert!((0.07..0.13).contains(&ratio), "{ratio}");
    let model = std::fs::read_to_string(folder.path().join("out/model.toml")).unwrap();
    assert!(model.contains("natural_frequency_hz = 10.15"), "{model}");
}

#[test]
fn several_moves_rest_between_and_payload_lowers_the_frequency() {
    let folder = TempDir::new().unwrap();
    let targets = "--target 30 --target -10 --target 0 --dwell 2";
    let document = simulate(folder.path(), targets);
    let moves = document["moves"].as_array().unwrap();
    assert_eq!(moves.len(), 3);
    for (pair, target) in moves.windows(2).zip([-10.0, 0.0]) {
        let rest = pair[1]["from_s"].as_f64().unwrap() - pair[0]["until_s"].as_f64().unwrap();
        assert!((rest - 2.0).abs() < 1e-9, "{rest}");
        assert!((pair[1]["target_deg"].as_f64().unwrap() - target).abs() < 1e-9);
    }
    let command = Recording::from_path(folder.path().join("out")).unwrap();
    let command = command.channel(Role::CommandPosition).unwrap();
    assert_eq!(command.columns[0].first(), Some(&0.0));
    assert!(command.columns[0].last().unwrap().abs() < 1e-12);

    // Stiffness constant: (f_0 / f)^2 - 1 = m r^2 / J is proportional to the payload.
    let slowed = |payload: &str| {
        let document = simulate(folder.path(), &format!("--payload {payload}"));
        let frequency = document["modes"][0]["frequency_hz"].as_f64().unwrap();
        (8.12 / frequency).powi(2) - 1.0
    };
    let (light, heavy) = (slowed("10"), slowed("30"));
    assert!(
        light > 0.01 && (heavy / light - 3.0).abs() < 1e-9,
        "{light} {heavy}"
    );
    // Stretched out, the arm carries more inertia about its base than bent.
    let at = |pose: &str| {
        let document = simulate(folder.path(), &format!("--pose {pose}"));
        document["modes"][0]["frequency_hz"].as_f64().unwrap()
    };
    assert!(at("0,90,0,0,0,0") < at("0,45,45,0,0,0") && at("0,0,90,0,0,0") > at("0,90,0,0,0,0"));
}

#[test]
fn the_seed_decides_the_noise_and_nothing_else() {
    let folder = TempDir::new().unwrap();
    for (seed, out) in [("1", "a"), ("1", "b"), ("2", "c")] {
        simulate(folder.path(), &format!("--seed {seed} --out {out}"));
    }
    let read = |name: &str| Recording::from_path(folder.path().join(name)).unwrap();
    let [a, b, c] = ["a", "b", "c"].map(read);
    assert_eq!(a, b);
    assert_eq!(
        a.channel(Role::MotorPosition),
        c.channel(Role::MotorPosition)
    );
    assert_ne!(a.channel(Role::TipPosition), c.channel(Role::TipPosition));
}

#[test]
fn bad_input_is_refused() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("moving.csv", "time_s,q\n0,0\n0.004,0.1\n0.008,0.2\n");
    write("short.csv", "time_s,q\n0,0\n");
    write("text.csv", "time_s,q\n0,0\n0.004,x\n");
    write("far.csv", "time_s,q\n0,1e9\n0.004,1e9\n");
    write("long.csv", "time_s,q\n0,0\n1e9,0\n");
    write("clock.csv", "tick,q\n0,0\n1,0\n");
    let manifest = "name = \"linear\"\n[[channel]]\nrole = \"command_position\"\nfile = \"short.csv\"\n\
                    time = \"time_s\"\ncolumn = \"q\"\nunit = \"mm\"\n";
    write("linear.toml", manifest);
    write(
        "none.toml",
        &manifest.replace("command_position", "motor_position"),
    );
    write(
        "two.toml",
        &(manifest.to_owned() + &manifest[manifest.find("[[").unwrap()..]),
    );
    for (arguments, words) in [
        ("--target nan", "--target"),
        (
            "--target 30 --target 30",
            "--target 30: the joint stands there already",
        ),
        ("--target 1e9", "longer than"),
        ("--target 1e12", "1e9"),
        ("--dwell -1", "--dwell"),
        ("--dwell 1e9", "samples"),
        ("--noise -1", "--noise"),
        ("--payload inf", "--payload"),
        ("--payload 1e6 --damping sideways", "--damping"),
        ("--joint 7", "joints 1 to 6"),
        ("--joint 0", "joints 1 to 6"),
        ("--joint 2 --shaper zv", "no mode to shape for"),
        ("--shaper zv --belief 1e-6,0.1", "ticks"),
        ("--mode 1e9,0.1", "steps of integration"),
        ("--command short.csv --column time_s", "it is the time"),
        ("--mode 8.12,1.5", "--mode"),
        ("--pose 1,2", "2 values for the 6 joints"),
        ("--pose 0,inf,0,0,0,0", "inf is not a finite number"),
        ("--shaper zv --command linear.toml", "--shaper"),
        ("--command moving.csv", "which column"),
        ("--command moving.csv --column p", "column \"p\""),
        ("--command moving.csv --column q", "not at rest"),
        ("--command moving.csv --column q --unit mm", "--unit mm"),
        ("--command moving.csv --column q --rate 100", "moving.csv:3"),
        ("--command short.csv --column q", "two samples"),
        ("--command text.csv --column q", "text.csv:3: column \"q\""),
        ("--command far.csv --column q", "1000000000 rad"),
        ("--command long.csv --column q", "samples"),
        ("--command clock.csv --column q", "--rate"),
        ("--command linear.toml", "in m, but the joint turns"),
        ("--command none.toml", "no command_position"),
        (
            "--command two.toml",
            "two.toml:9: role: \"command_position\" stands twice",
        ),
        ("--command absent", "absent"),
        (
            "--command linear.toml --out .",
            "--out .: the command is in that folder",
        ),
        ("--rate 250", "--column"),
    ] {
        let arguments: Vec<&str> = ["simulate"]
            .into_iter()
            .chain(arguments.split(' '))
            .collect();
        let assert = quell(folder.path(), &arguments).assert().code(2).stdout("");
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        let told = stderr.starts_with("error: ") && stderr.contains(words);
        assert!(told, "{arguments:?}: no {words:?} in {stderr}");
    }
}

/// The command that `quell inspect` proposes for the folder identifies the mode, with the model beside it.
#[test]
fn what_inspect_proposes_for_a_simulated_folder_runs() {
    let folder = TempDir::new().unwrap();
    let arguments = ["simulate", "--out", "sim"];
    quell(folder.path(), &arguments).assert().success();
    let assert = quell(folder.path(), &["inspect", "sim"]).assert().success();
    let said = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    let next = said.lines().last().unwrap_or_default();
    assert_eq!(next, "Next: quell identify sim --model sim/model.toml");
    let words: Vec<_> = next.split(' ').skip(2).collect();
    quell(folder.path(), &words).assert().success();
    // Without the model the error says what is needed.
    let assert = quell(folder.path(), &["identify", "sim"]).assert().code(2);
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("--model FILE"), "{said}");
}

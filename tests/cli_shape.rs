//! `quell shape` as a user types it: the train, the shaped file, and what is refused.

use assert_cmd::Command;
use flate2::read::GzDecoder;
use serde_json::Value;
use std::io::Read;
use std::path::Path;
use tempfile::TempDir;

fn shape(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("quell").unwrap();
    command.arg("shape").args(arguments);
    command
}

fn shape_json(arguments: &[&str]) -> Value {
    let assert = shape(arguments).arg("--json").assert().success();
    serde_json::from_slice(&assert.get_output().stdout).unwrap()
}

fn refused(command: &mut Command, words: &[&str]) {
    let assert = command.assert().code(2).stdout("");
    let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    for word in words {
        assert!(stderr.contains(word), "no {word:?} in {stderr}");
    }
}

/// A ramp of 0.5 rad in 0.4 s at 250 Hz, with a column of words and one of another axis.
fn command_file(folder: &Path) -> String {
    let mut csv = String::from("time_s,joint_1_rad,note,joint_2_rad\n");
    for sample in 0..=100 {
        let time = f64::from(sample) / 250.0;
        csv.push_str(&format!(
            "{time:.3},{},row {sample},{}\n",
            1.25 * time,
            -time
        ));
    }
    let path = folder.join("command.csv");
    std::fs::write(&path, csv).unwrap();
    path.to_str().unwrap().into()
}

/// The text with every stretch of white space as one space.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn rows(text: &str) -> Vec<Vec<String>> {
    text.lines()
        .map(|line| line.split(',').map(str::to_owned).collect())
        .collect()
}

fn numbers(rows: &[Vec<String>], column: usize) -> Vec<f64> {
    rows[1..]
        .iter()
        .map(|row| row[column].parse().unwrap())
        .collect()
}

#[test]
fn the_optimal_shaper_is_solved_for_what_is_known_of_the_mode() {
    let base = [
        "--shaper",
        "optimal",
        "--mode",
        "8.12,0.084",
        "--rate",
        "1000",
    ];
    let longest = |json: &Value| {
        let impulses = json["impulses"].as_array().unwrap();
        impulses[impulses.len() - 1]["time_s"].as_f64().unwrap()
    };
    let [hardly, well] = [
        vec![],
        vec!["--frequency-std", "0.5", "--damping-std", "0.005"],
    ]
    .map(|more| longest(&shape_json(&[&base[..], &more].concat())));
    // Known to 1 % half a period is enough; to 10 % it is not.
    assert!(well < 0.6 * hardly, "{well} {hardly}");
    let other = [
        "--shaper",
        "zvd",
        "--mode",
        "8,0.1",
        "--rate",
        "250",
        "--frequency-std",
        "3",
    ];
    refused(&mut shape(&other), &["--shaper optimal", "zvd"]);
}

#[test]
fn val_trains_are_those_of_the_literature() {
    // Singer and Seering (1990) at 8.12 Hz and a damping ratio of 0.084: K = 0.767337.
    let zv = shape_json(&["--shaper", "zv", "--mode", "8.12,0.084", "--rate", "250"]);
    let amplitude = |index: usize| zv["impulses"][index]["amplitude"].as_f64().unwrap();
    assert!((amplitude(0) - 0.56582).abs() < 5e-6 && (amplitude(1) - 0.43418).abs() < 5e-6);
    // 0.50177 periods of 1 / 8.12 Hz, to half a unit of the last digit of 0.50177.
    assert!((zv["duration_s"].as_f64().unwrap() * 8.12 - 0.50177).abs() < 5e-6);
    let delays: Vec<&Value> = zv["taps"]
        .as_array()
        .unwrap()
        .iter()
        .map(|tap| &tap["delay_ticks"])
        .collect();
    assert_eq!(delays, [0, 15, 16]);
    let residual = zv["modes"][0]["residual_vibration"].as_f64().unwrap();
    assert!(residual < 1e-12, "{residual}");
}

#[test]
fn several_modes_are_shaped_for_at_once() {
    let modes = ["--mode", "8.12,0.084", "--mode", "21,0.02"];
    let both = shape_json(&[&["--shaper", "zvd", "--rate", "1000"], &modes[..]].concat());
    for mode in both["modes"].as_array().unwrap() {
        assert!(
            mode["residual_vibration"].as_f64().unwrap() < 1e-12,
            "{mode}"
        );
    }
}

#[test]
fn a_shaped_file_keeps_its_columns_ends_on_the_target_and_leaves_no_vibration() {
    let folder = TempDir::new().unwrap();
    let (file, out) = (command_file(folder.path()), folder.path().join("shaped"));
    let design = ["--shaper", "zvd", "--mode", "8.12,0.084", "--rate", "250"];
    let files = [
        &file,
        "--column",
        "joint_1_rad",
        "--out",
        out.to_str().unwrap(),
    ];
    let told = shape_json(&[&design[..], &files[..]].concat());
    assert_eq!(told["file"]["rows"], 133);
    assert_eq!(told["file"]["appended_rows"], 32);

    let before = rows(&std::fs::read_to_string(&file).unwrap());
    let after = rows(&std::fs::read_to_string(out.join("command_shaped.csv")).unwrap());
    for (old, new) in before.iter().zip(&after) {
        assert_eq!((&old[0], &old[2..]), (&new[0], &new[2..]));
    }
    let last = after.last().unwrap();
    assert_eq!(
        (last[0].as_str(), last[1].as_str(), last[3].as_str()),
        ("0.528", "0.5", "-0.4")
    );

    // Vibration that the command leaves at the mode: |sum of du_k exp(-lambda t_k)|, with
    // lambda = -xi w + j w_d, over the same of the unshaped command. It is 0 but for rounding of the file's
    // values to 1e-12: at most half of that in each of 133 steps, twice, times exp(xi w 0.528 s) = 10.
    let (frequency, damping_ratio) = (std::f64::consts::TAU * 8.12, 0.084_f64);
    let damped = frequency * (1.0 - damping_ratio * damping_ratio).sqrt();
    let left = |rows: &[Vec<String>]| {
        let (time, command) = (numbers(rows, 0), numbers(rows, 1));
        let sum = (1..time.len()).fold((0.0, 0.0), |sum: (f64, f64), k| {
            let step = (command[k] - command[k - 1]) * (damping_ratio * frequency * time[k]).exp();
            (
                sum.0 + step * (damped * time[k]).cos(),
                sum.1 + step * (damped * time[k]).sin(),
            )
        });
        sum.0.hypot(sum.1)
    };
    assert!(left(&after) < 2e-9, "{}", left(&after));
    assert!(left(&before) > 1e-3, "the test's command excites the mode");
    let cells = || after.iter().flat_map(|row| [&row[0], &row[1], &row[3]]);
    let digits = |cell: &String| cell.split_once('.').map_or(0, |(_, digits)| digits.len());
    assert!(cells().all(|cell| digits(cell) <= 12), "{after:?}");
}

#[test]
fn shaping_twice_by_zv_is_shaping_once_by_zvd() {
    let folder = TempDir::new().unwrap();
    let (file, out) = (
        command_file(folder.path()),
        folder.path().to_str().unwrap().to_owned(),
    );
    let run = |shaper: &str, file: &str| {
        let design = ["--shaper", shaper, "--mode", "8.12,0.084", "--rate", "250"];
        let files = [file, "--column", "joint_1_rad", "--out", &out];
        let told = shape_json(&[&design[..], &files[..]].concat());
        let path = told["file"]["path"].as_str().unwrap().to_owned();
        (
            numbers(&rows(&std::fs::read_to_string(&path).unwrap()), 1),
            path,
        )
    };
    let (_, once) = run("zv", &file);
    let (twice, _) = run("zv", &once);
    let (zvd, _) = run("zvd", &file);
    assert_eq!(twice.len(), zvd.len());
    for (twice, zvd) in twice.iter().zip(&zvd) {
        // Three files are written to 1e-12, and a train of ZV does not enlarge the first one's rounding.
        assert!((twice - zvd).abs() < 2e-12, "{twice} {zvd}");
    }
}

#[test]
fn gzip_and_semicolons_are_kept() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("command.csv.gz");
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut gzip, b"q;word\n0;a\n1;b\n").unwrap();
    std::fs::write(&path, gzip.finish().unwrap()).unwrap();
    let out = folder.path().join("new/folder");
    let design = ["--shaper", "zv", "--mode", "10,0", "--rate", "40"];
    let files = [
        path.to_str().unwrap(),
        "--column",
        "q",
        "--out",
        out.to_str().unwrap(),
    ];
    shape(&[&design[..], &files[..]].concat())
        .assert()
        .success();
    let bytes = std::fs::read(out.join("command_shaped.csv.gz")).unwrap();
    let mut text = String::new();
    GzDecoder::new(bytes.as_slice())
        .read_to_string(&mut text)
        .unwrap();
    // Undamped, half a period is two ticks: half of the step at once, half two rows later.
    assert_eq!(text, "q;word\n0.0;a\n0.5;b\n0.5;b\n1.0;b\n");
}

#[test]
fn bad_input_is_refused_with_its_place() {
    let folder = TempDir::new().unwrap();
    let file = command_file(folder.path());
    let zv = ["--shaper", "zv", "--mode", "8.12,0.084", "--rate"];
    let with = |rate: &str, rest: &[&str]| shape(&[&zv[..], &[rate], rest].concat());
    refused(
        &mut with("200", &[&file, "--column", "joint_1_rad"]),
        &[
            "command.csv:5: column \"time_s\"",
            "\"0.012\"",
            "200 Hz",
            "250.00 Hz",
        ],
    );
    refused(
        &mut with("250", &[&file, "--column", "joint_9_rad"]),
        &[
            "command.csv:1: column \"joint_9_rad\"",
            "no such column",
            "joint_2_rad",
        ],
    );
    refused(
        &mut with("250", &[&file, "--column", "note"]),
        &[
            "command.csv:2: column \"note\"",
            "\"row 0\" is not a number",
        ],
    );
    refused(
        &mut with("250", &[&file, "--column", "time_s"]),
        &["it is the time"],
    );
    refused(&mut with("250", &[&file]), &["--column"]);
    refused(
        &mut with("250", &["none.csv", "--column", "x"]),
        &["none.csv: no such file"],
    );
    refused(&mut with("0", &[]), &["above 0"]);
    refused(&mut with("10", &[]), &["error: "]);
    refused(&mut with("1e8", &[]), &["more than 1000000 samples"]);
    refused(
        &mut shape(&["--shaper", "zz", "--mode", "8,0", "--rate", "250"]),
        &["zvdd"],
    );
    for mode in ["8.12", "8.12,1.0", "-8,0.1", "nan,0.1", "8;0.1"] {
        let mode = format!("--mode={mode}");
        refused(
            &mut shape(&["--shaper", "zv", &mode, "--rate", "250"]),
            &["--mode"],
        );
    }
}

#[test]
fn every_shaper_of_the_help_can_be_asked_for() {
    let assert = shape(&["--help"]).assert().success();
    let help = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert!(help.contains("Examples:"), "{help}");
    for shaper in quell_shapers::SHAPERS {
        assert!(words(&help).contains(&words(shaper.summary())), "{help}");
        shape(&[
            "--shaper",
            shaper.name(),
            "--mode",
            "8.12,0.084",
            "--rate",
            "250",
        ])
        .assert()
        .success();
    }
}

/// The modes of a recording, without a file between.
#[test]
fn a_recording_says_the_mode() {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("decay.csv");
    let (w, xi) = (std::f64::consts::TAU * 8.12, 0.02);
    let mut csv = String::from("time_s,accel_m_s2\n");
    for k in 0..3000 {
        let t = f64::from(k) / 1000.0;
        // Noise of a sine that no mode has: its period is no multiple of the samples'.
        let noise = 1e-3 * (f64::from(k * k % 7919) * 0.37).sin();
        csv.push_str(&format!(
            "{t:.3},{:.6}\n",
            (-xi * w * t).exp() * (w * t).cos() + noise
        ));
    }
    std::fs::write(&file, csv).unwrap();
    let file = file.to_str().unwrap();
    let document = shape_json(&["--shaper", "zvd", "--recording", file, "--rate", "250"]);
    let mode = &document["modes"][0];
    let hertz = mode["frequency_hz"].as_f64().unwrap();
    assert!((hertz / 8.12 - 1.0).abs() < 1e-3, "{document}");
    let mut compare = Command::cargo_bin("quell").unwrap();
    compare.current_dir(folder.path());
    let told = compare.args(["compare", "--recording", file, "--rate", "250", "--json"]);
    let told: Value = serde_json::from_slice(&told.assert().success().get_output().stdout).unwrap();
    assert_eq!(told["modes"][0]["frequency_hz"], mode["frequency_hz"]);
    refused(
        &mut shape(&[
            "--shaper",
            "zv",
            "--recording",
            file,
            "--mode",
            "8,0.1",
            "--rate",
            "250",
        ]),
        &["cannot be used with"],
    );
    refused(
        &mut shape(&["--shaper", "zv", "--rate", "250"]),
        &["--recording RECORDING"],
    );
}

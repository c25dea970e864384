//! `quell inspect` as a user types it: what it prints, and what it refuses.

mod manifests;

use assert_cmd::Command;
use flate2::{Compression, write::GzEncoder};
use serde_json::Value;
use std::io::Write;
use tempfile::TempDir;

const MANIFEST: &str = r#"name = "arm 7"

[[channel]]
role = "motor_position"
file = "encoder.csv"
time = "time_s"
column = "joint_1_rad"
unit = "rad"
"#;
const CSV: &[u8] = b"time_s,joint_1_rad\n0.000,0.1\n0.004,0.2\n0.008,0.3\n";

fn folder(manifest: &str, files: &[(&str, &[u8])]) -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("recording.toml"), manifest).unwrap();
    for (name, bytes) in files {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    folder
}

fn inspect(folder: &TempDir) -> Command {
    let mut command = Command::cargo_bin("quell").unwrap();
    command.arg("inspect").arg(folder.path());
    command
}

fn inspect_json(folder: &TempDir) -> Value {
    let output = inspect(folder).arg("--json").assert().success();
    serde_json::from_slice(&output.get_output().stdout).unwrap()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// Exit code 2, nothing on stdout, and one message that holds all the words.
fn refused(case: &str, folder: &TempDir, words: &[&str]) {
    let assert = inspect(folder).assert().code(2).stdout("");
    let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(stderr.starts_with("error: "), "{case}: {stderr}");
    for word in words {
        assert!(stderr.contains(word), "{case}: no {word:?} in {stderr}");
    }
}

#[test]
fn bad_csv_is_refused_with_file_line_and_column() {
    let cell = "encoder.csv:3: column \"joint_1_rad\"";
    let cases: &[(&str, &[u8], &[&str])] = &[
        (
            "text",
            b"time_s,joint_1_rad\n0,1\n1,abc\n",
            &[cell, "\"abc\" is not a number"],
        ),
        (
            "empty cell",
            b"time_s,joint_1_rad\n0,1\n1,\n",
            &[cell, "empty"],
        ),
        (
            "nan",
            b"time_s,joint_1_rad\n0,1\n1,NaN\n",
            &[cell, "\"NaN\" is not a finite number"],
        ),
        (
            "infinity",
            b"time_s,joint_1_rad\n0,1\n1,-inf\n",
            &[cell, "\"-inf\""],
        ),
        (
            "overflow",
            b"time_s,joint_1_rad\n0,1\n1,1e999\n",
            &[cell, "\"1e999\""],
        ),
        (
            "crlf",
            b"time_s,joint_1_rad\r\n0,1\r\n1,x\r\n",
            &[cell, "\"x\""],
        ),
        (
            "blank lines count as an editor counts them",
            b"\n\ntime_s,joint_1_rad\n\n0,1\n \n1,x\n",
            &["encoder.csv:7: column \"joint_1_rad\""],
        ),
        (
            "decimal comma",
            b"time_s;joint_1_rad\n0;1\n1;0,5\n",
            &[cell, "\"0,5\"", "decimal comma"],
        ),
        (
            "time backwards",
            b"time_s,joint_1_rad\n0,1\n2,1\n1.5,1\n",
            &[
                "encoder.csv:4: column \"time_s\"",
                "time runs backwards",
                "\"1.5\"",
                "2 s",
            ],
        ),
        (
            "time repeats",
            b"time_s,joint_1_rad\n0,1\n2,1\n2.0,1\n",
            &[
                "encoder.csv:4: column \"time_s\"",
                "time repeats",
                "\"2.0\"",
            ],
        ),
        (
            "missing column",
            b"time_s,joint_2_rad\n0,1\n",
            &[
                "encoder.csv:1: column \"joint_1_rad\"",
                "the columns are: time_s, joint_2_rad",
            ],
        ),
        (
            "column twice",
            b"time_s,joint_1_rad,joint_1_rad\n0,1,1\n",
            &["encoder.csv:1: column \"joint_1_rad\"", "2 times"],
        ),
        ("empty", b"", &["encoder.csv: the file is empty"]),
        ("blank", b"\n \n\n", &["encoder.csv: the file is empty"]),
        (
            "header only",
            b"time_s,joint_1_rad\n",
            &["encoder.csv: the file has a header but no"],
        ),
        (
            "ragged",
            b"time_s,joint_1_rad\n0,1\n1\n",
            &["encoder.csv:3: 1 cells where the header has 2"],
        ),
        (
            "not utf-8",
            b"time_s,joint_1_rad\n0,1\n\x81,1\n",
            &["encoder.csv:3: the text is not"],
        ),
    ];
    for (case, csv, words) in cases {
        refused(case, &folder(MANIFEST, &[("encoder.csv", csv)]), words);
    }
}

#[test]
fn damaged_gzip_is_refused() {
    let manifest = MANIFEST.replace("encoder.csv", "encoder.csv.gz");
    let whole = gzip(&CSV.repeat(100));
    for (case, bytes, word) in [
        ("truncated", &whole[..whole.len() / 2], "ends early"),
        ("not gzip", CSV, "gzip"),
        ("empty", b"".as_slice(), "the file is empty"),
    ] {
        refused(
            case,
            &folder(&manifest, &[("encoder.csv.gz", bytes)]),
            &["encoder.csv.gz: ", word],
        );
    }
}

#[test]
fn bad_manifests_are_refused_with_line_and_key() {
    let unit = r#"unit = "rad""#;
    let cases: &[(&str, String, &[&str])] = &[
        (
            "role",
            MANIFEST.replace("motor_position", "motor_postion"),
            &[
                "recording.toml:4: unknown role",
                "\"motor_postion\"",
                "mean \"motor_position\"",
            ],
        ),
        (
            "unit",
            MANIFEST.replace(unit, "unit = \"degs\""),
            &["recording.toml:8: unknown unit \"degs\"", "mean \"deg\""],
        ),
        (
            "no closing quote",
            MANIFEST.replace(unit, "unit = \"rad"),
            &["recording.toml:8:12: unit = \"rad: the closing \" is missing"],
        ),
        (
            "unknown key",
            MANIFEST.replace("column =", "colum ="),
            &["recording.toml:7: unknown key \"colum\"", "mean \"column\""],
        ),
        (
            "missing key",
            MANIFEST.replace(unit, ""),
            &["recording.toml:3: ", "unit"],
        ),
        (
            "wrong type",
            MANIFEST.replace(unit, "unit = 3"),
            &["recording.toml:8: channel[1].unit = 3: it must be a text in quotes"],
        ),
        (
            "syntax",
            MANIFEST.replace(unit, "unit = "),
            &["recording.toml:8:8: unit = : there is no value behind ="],
        ),
        (
            "missing file",
            MANIFEST.replace("encoder.csv", "encodr.csv"),
            &["recording.toml:5: file: there is no file", "encodr.csv"],
        ),
        (
            "no clock",
            MANIFEST.replace("time =", "#"),
            &["recording.toml:4: time: give either"],
        ),
        (
            "two clocks",
            MANIFEST.replace(unit, "unit = \"rad\"\nrate_hz = 5"),
            &["recording.toml:4: time: give either"],
        ),
        (
            "rate",
            MANIFEST.replace("time = \"time_s\"", "rate_hz = -500"),
            &["recording.toml:6: rate_hz: -500 is not a rate above 0"],
        ),
        (
            "scale",
            MANIFEST.replace(unit, "unit = \"rad\"\nscale = nan"),
            &["recording.toml:9: scale: NaN is not a finite number"],
        ),
        (
            "rows past the end",
            MANIFEST.replace(unit, "unit = \"rad\"\nrows = [1, 4]"),
            &["recording.toml:9: rows: the file has 3 rows, so it ends before row 4"],
        ),
        (
            "no rows",
            MANIFEST.replace("arm 7\"", "arm 7\"\nrows = [2, 2]"),
            &["recording.toml:2: rows: from row 2 up to before row 2 there is no row"],
        ),
        (
            "rows from below 0",
            MANIFEST.replace("arm 7\"", "arm 7\"\nrows = [-1, 2]"),
            &["recording.toml:2: ", "-1"],
        ),
        (
            "columns of a vector",
            MANIFEST
                .replace("motor_position", "tip_position")
                .replace(unit, "unit = \"m\""),
            &["recording.toml:4: columns: tip_position takes 3 column(s), not 1"],
        ),
        (
            "no channels",
            "name = \"x\"\nchannel = []\n".into(),
            &["channel: there is none: write a block [[channel]]"],
        ),
        (
            "empty",
            String::new(),
            &["recording.toml:1: missing key `name`"],
        ),
    ];
    for (case, manifest, words) in cases {
        refused(case, &folder(manifest, &[("encoder.csv", CSV)]), words);
    }
}

/// Error for a `.parquet` file that is not one.
const PARQUET: &str = match cfg!(feature = "parquet") {
    true => "byte 0: the Parquet data cannot be read: it does not begin with PAR1",
    false => {
        "a Parquet file is not read: build quell with --features parquet, or read it with quell in Python"
    }
};

#[test]
fn a_path_that_is_no_recording_is_refused_with_a_way_out() {
    let empty = TempDir::new().unwrap();
    refused(
        "folder without manifest",
        &empty,
        &["has no recording.toml", "help: ", "[[channel]]"],
    );
    let folder = folder(MANIFEST, &[("encoder.csv", CSV)]);
    for (name, word) in [
        ("nothing.toml", "no such file"),
        (
            "run.mat",
            "quell.Recording.load(\"run.mat\", {\"deformation\": \"y\"}, time=\"t\")",
        ),
        ("run.db3", "a ROS 2 bag (SQLite) is not read"),
        ("run.bag", "a ROS 1 bag is not read"),
        ("run.parquet", PARQUET),
        ("run.xlsx", "a spreadsheet is not read"),
        (
            "run.npz",
            "quell.Recording.load(\"run.npz\", {\"deformation\": \"y\"}, time=\"t\")",
        ),
        ("run.npy", "a NumPy file is not read"),
    ] {
        if name != "nothing.toml" {
            std::fs::write(folder.path().join(name), b"\0\x01secret = 3").unwrap();
        }
        let mut command = Command::cargo_bin("quell").unwrap();
        let assert = command.arg("inspect").arg(folder.path().join(name));
        let assert = assert.assert().code(2);
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(stderr.contains(name) && stderr.contains(word), "{stderr}");
        assert!(!stderr.contains("secret"), "{stderr}");
    }
}

#[test]
fn separators_marks_and_units_are_read_as_meant() {
    let scaled = MANIFEST
        .replace("rad\"\n", "deg\"\nscale = 2\noffset = 10\n")
        .replace(
            "column = \"joint_1_deg\"\nscale = 2\noffset = 10",
            "column = \"joint_1_rad\"",
        );
    for csv in [
        "\u{feff}time_s,joint_1_rad\n0,85\n0.5,175\n",
        "time_s;joint_1_rad\r\n0;85\r\n0.5;175\r\n",
        "time_s\tjoint_1_rad\n0\t 85\n0.5\t1.75e2",
        "\"time_s\",\"joint_1_rad\"\n\"0\",\"85\"\n\"0.5\",\"175\"\n",
    ] {
        let figures = inspect_json(&folder(&scaled, &[("encoder.csv", csv.as_bytes())]));
        let channel = &figures["channels"][0];
        assert_eq!(channel["unit"], "rad", "{csv}");
        assert_eq!(channel["rate_hz"], 2.0, "{csv}");
        // 180 and 360 degrees.
        assert_eq!(
            channel["columns"][0]["minimum"],
            std::f64::consts::PI,
            "{csv}"
        );
        assert_eq!(
            channel["columns"][0]["maximum"],
            std::f64::consts::TAU,
            "{csv}"
        );
    }
}

#[test]
fn a_range_of_rows_keeps_its_stamps() {
    let range = |first, last| format!("arm 7\"\nrows = [{first}, {last}]");
    let own = MANIFEST.replace("\"rad\"", "\"rad\"\nrows = [1, 3]");
    let at_a_rate = MANIFEST.replace("time = \"time_s\"", "rate_hz = 250");
    for manifest in [
        MANIFEST.replace("arm 7\"", &range(1, 3)),
        at_a_rate.replace("arm 7\"", &range(1, 3)),
        // A channel's own range comes before the recording's.
        own.replace("arm 7\"", &range(0, 1)),
    ] {
        let recording = folder(&manifest, &[("encoder.csv", CSV)]);
        let recording = quell::recording::Recording::from_path(recording.path()).unwrap();
        assert_eq!(recording.channels[0].time, [0.004, 0.008], "{manifest}");
        assert_eq!(recording.channels[0].columns, [[0.2, 0.3]], "{manifest}");
    }
}

#[test]
fn val_noise_step_gaps_and_faults_are_found() {
    // A 2 Hz oscillation of 0.1 rad at 500 Hz, rounded to 1e-4 rad, clipped above 0.08 rad, with
    // 20 samples missing after 1 s, one sample lost to 1 rad, and one turn added after 3 s.
    let mut csv = String::from("time_s,joint_1_rad\n");
    for sample in (0..2000).filter(|sample| !(500..520).contains(sample)) {
        let time = sample as f64 / 500.0;
        let angle = (0.1 * (std::f64::consts::TAU * 2.0 * time).sin()).min(0.08);
        let turn = if sample >= 1500 {
            std::f64::consts::TAU
        } else {
            0.0
        };
        let value = if sample == 900 {
            1.0
        } else {
            (angle * 1e4).round() / 1e4 + turn
        };
        csv.push_str(&format!("{time},{value}\n"));
    }
    let figures = inspect_json(&folder(MANIFEST, &[("encoder.csv", csv.as_bytes())]));
    let channel = &figures["channels"][0];
    assert_eq!(channel["missing_samples"], 20);
    assert_eq!(channel["gaps"][0]["until_s"], 1.04);
    let column = &channel["columns"][0];
    assert_eq!(column["spikes_s"], serde_json::json!([1.8]));
    assert_eq!(column["wraps_s"], serde_json::json!([3.0]));
    let step = column["quantisation_step"].as_f64().unwrap();
    assert!((step - 1e-4).abs() < 1e-7, "{step}");
    let remarks = channel["remarks"].to_string();
    for word in [
        "20 missing samples",
        "hangs",
        "jumps by a turn",
        "1 lone sample",
    ] {
        assert!(remarks.contains(word), "no {word:?} in {remarks}");
    }
}

#[test]
fn a_closed_pipe_ends_quietly() {
    let folder = folder(MANIFEST, &[("encoder.csv", CSV)]);
    let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("quell"))
        .arg("inspect")
        .arg(folder.path())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0));
}

#[test]
fn the_log_is_on_stderr_and_asked_for() {
    let folder = folder(MANIFEST, &[("encoder.csv", CSV)]);
    inspect(&folder).assert().success().stderr("");
    for command in [
        inspect(&folder).arg("-v"),
        inspect(&folder).env("QUELL_LOG", "quell=info"),
    ] {
        let assert = command.assert().success();
        let log = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(
            log.contains("reading") && log.contains("encoder.csv"),
            "{log}"
        );
    }
}

#[test]
fn help_shows_an_example_and_an_unknown_verb_is_bad_input() {
    let quell = || Command::cargo_bin("quell").unwrap();
    for verb in ["compare", "inspect", "shape"] {
        let assert = quell().args([verb, "--help"]).assert().success();
        let help = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
        assert!(
            help.contains(&format!("Examples:\n  quell {verb} ")),
            "{help}"
        );
    }
    quell().arg("inspekt").assert().code(2);
    quell().arg("inspect").assert().code(2);
}

/// Role, samples, and rate in Hz of a channel.
type Expected = (&'static str, u64, f64);

#[test]
fn shared_recordings_are_read() {
    // Role, samples, rate in Hz of each channel, as the recordings' own description has them.
    let cases: [(&str, &[Expected]); 4] = [
        (
            "quanser_lqg_step_20deg.toml",
            &[
                ("command_position", 2000, 500.0),
                ("motor_position", 2000, 500.0),
                ("deformation", 2000, 500.0),
            ],
        ),
        (
            "flexarm_square.toml",
            &[
                ("motor_voltage", 3001, 50.0),
                ("motor_position", 3001, 50.0),
                ("deformation", 3001, 50.0),
            ],
        ),
        (
            "silverbox.toml",
            &[("force", 131_072, 610.35), ("deformation", 131_072, 610.35)],
        ),
        (
            "arts_1hz_20lb.toml",
            &[
                ("link_position", 10_241, 1024.0),
                ("force", 10_241, 1024.0),
                ("link_velocity", 10_241, 1024.0),
            ],
        ),
    ];
    for (manifest, expected) in cases {
        let Some(folder) = manifests::shared(manifest) else {
            continue;
        };
        let figures = inspect_json(&folder);
        for (channel, (role, samples, rate_hz)) in
            figures["channels"].as_array().unwrap().iter().zip(expected)
        {
            assert_eq!(channel["role"], *role, "{manifest}");
            assert_eq!(channel["samples"], *samples, "{manifest}");
            // Stamps are printed to 1e-7 s, a share of 1e-4 of the shortest period.
            assert!((channel["rate_hz"].as_f64().unwrap() / rate_hz - 1.0).abs() < 1e-4);
        }
    }
}

#[test]
fn clocks_that_show_nothing_are_told() {
    let folder = TempDir::new().unwrap();
    let manifest = "name = \"odd\"\n[[channel]]\nrole = \"motor_position\"\nfile = \"a.csv\"\n\
                    time = \"t\"\ncolumn = \"q\"\nunit = \"rad\"\n";
    let again = manifest[manifest.find("[[").unwrap()..].replace("motor", "link");
    let manifest = manifest.to_owned() + &again;
    std::fs::write(folder.path().join("recording.toml"), manifest).unwrap();
    let milliseconds: String = (0..50).map(|k| format!("{},0.{k:02}\n", 4 * k)).collect();
    for (rows, words) in [
        ("0,1\n", "one sample only"),
        (&milliseconds, "its time may not be in seconds"),
    ] {
        std::fs::write(folder.path().join("a.csv"), format!("t,q\n{rows}")).unwrap();
        let mut command = Command::cargo_bin("quell").unwrap();
        command.arg("inspect").arg(folder.path());
        let assert = command.assert().success();
        let text = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
        assert!(text.contains(words), "no {words:?} in {text}");
        // Two channels at the same instants have their time in common.
        assert!(!text.contains("no time in common"), "{text}");
    }
}

/// Of stamps that are rounded to microseconds the median interval of 3200 Hz is 312 us, which is 3205.13 Hz. Every second one lies between
/// two microseconds: no other period has such stamps, however few they are.
#[test]
fn the_rate_is_that_of_all_stamps_together() {
    for samples in [3200_u32, 64] {
        let mut csv = String::from("time_s,joint_1_rad\n");
        for k in 0..samples {
            csv += &format!("{:.6},{}\n", f64::from(k) / 3200.0, k % 7);
        }
        let folder = folder(MANIFEST, &[("encoder.csv", csv.as_bytes())]);
        let told = inspect_json(&folder);
        let number = |key: &str| told["channels"][0][key].as_f64().unwrap();
        assert!((number("rate_hz") - 3200.0).abs() < 1e-3, "{told}");
        assert!(number("rate_std_hz") < 1e-3, "{told}");
        let output = inspect(&folder).assert().success();
        let text = String::from_utf8_lossy(&output.get_output().stdout).into_owned();
        assert!(text.contains("3200.00") && !text.contains("3205"), "{text}");
    }
}

/// What an arm carries is a column of the log: each payload is a recording that declares it, whether its time begins again or
/// goes on.
#[test]
fn val_a_column_of_payloads_is_declared() {
    for goes_on in [false, true] {
        let folder = TempDir::new().unwrap();
        let mut text = String::from("time_s,payload_kg,motor_deg,link_deg\n");
        for (block, payload) in ["0", "1.5"].into_iter().enumerate() {
            for k in 0..200 {
                let t = f64::from(k) * 0.002 + if goes_on { block as f64 } else { 0.0 };
                let motor = (9.0 * t).sin();
                text += &format!("{t},{payload},{motor},{}\n", 1.01 * motor);
            }
        }
        let file = folder.path().join("moves.csv");
        std::fs::write(&file, text).unwrap();
        let mut command = Command::cargo_bin("quell").unwrap();
        command.arg("inspect").arg(&file).assert().success();
        for (manifest, payload) in [("recording.toml", "0 kg"), ("moves_1.5.toml", "1.5 kg")] {
            let text = std::fs::read_to_string(folder.path().join(manifest)).unwrap();
            assert!(text.contains(&format!("payload = \"{payload}\"")), "{text}");
            assert!(!text.contains("not used"), "{text}");
        }
    }
}

/// A proposed manifest whose blocks are all comments lacks no key: it is to be filled in.
#[test]
fn a_manifest_of_blocks_to_fill_in_says_so() {
    let manifest = "name = \"run\"\n\n# Fill in role and unit.\n# [[channel]]\n# role = \"\"\n";
    let words = [
        "recording.toml:4: channel: there is none yet",
        "fill in role and unit",
    ];
    refused("comments", &folder(manifest, &[]), &words);
}

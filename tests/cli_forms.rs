//! CSV files as tools write them: what `quell inspect` proposes, and what is read without a manifest.

use assert_cmd::Command;
use serde_json::Value;
use std::f64::consts::TAU;
use std::path::Path;
use tempfile::TempDir;

/// A decay of 8 Hz with a damping ratio of 0.02.
fn decay(time: f64) -> f64 {
    let omega = TAU * 8.0;
    (-0.02 * omega * time).exp() * (omega * (1.0_f64 - 0.0004).sqrt() * time).sin()
}

fn rows(line: impl Fn(usize) -> String) -> String {
    (0..4000).map(line).collect()
}

fn write(name: &str, text: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join(name), text).unwrap();
    folder
}

fn json(verb: &str, path: &Path, folder: &TempDir) -> Value {
    let mut command = Command::cargo_bin("quell").unwrap();
    command
        .current_dir(folder.path())
        .args([verb, "--json"])
        .arg(path);
    let output = command.assert().success();
    serde_json::from_slice(&output.get_output().stdout).unwrap()
}

/// Name of the file, its text, lines that the proposal has, and whether it is certain.
fn forms() -> Vec<(&'static str, String, Vec<&'static str>, bool)> {
    let ms = |k: usize| k as f64 / 1000.0;
    let comma = |text: String| text.replace('.', ",");
    vec![
        (
            "german.csv",
            "\u{feff}Device;X1\nDate;today\n\nZeit [ms];acceleration x [g]\n".to_owned()
                + &rows(|k| comma(format!("{k};{:.5}\n", decay(ms(k))))),
            vec![
                "decimal = \",\"",
                "skip = 3",
                "time_unit = \"ms\"",
                "unit = \"g\"",
            ],
            true,
        ),
        (
            "labview.lvm",
            "LabVIEW Measurement\nWriter_Version\t2\nSeparator\tTab\n***End_of_Header***\nX_Value\tAcceleration\n".to_owned()
                + &rows(|k| format!("{:.6}\t{:.6}\n", ms(k), decay(ms(k)))),
            vec!["skip = 4", "column = \"Acceleration\""],
            false,
        ),
        (
            "scope.txt",
            "# scope 7\nt a\ns m/s^2\n".to_owned()
                + &rows(|k| format!("{:.3}    {:.5}\n", ms(k), decay(ms(k)))),
            vec![
                "delimiter = \" \"",
                "header = false",
                "unit = \"m/s^2\"",
                "column = \"2\"  # a [m/s^2]",
            ],
            true,
        ),
        (
            "epoch.csv",
            "timestamp,acc_x,acc_y\n".to_owned()
                + &rows(|k| {
                    let blank = if k % 50 == 3 { "" } else { "0.5" };
                    format!(
                        "{},{:.5},{blank}\n",
                        1_700_000_000_000_000_000 + 1_000_000 * k as u64,
                        decay(ms(k))
                    )
                }),
            vec!["time_unit = \"ns\"", "missing = [\"\"]  # guessed"],
            true,
        ),
        (
            "iso.csv",
            "time;accel_x_mm_s2\n".to_owned()
                + &rows(|k| format!("2024-02-29T23:59:{:06.3}Z;{:.5}\n", ms(k), decay(ms(k)))),
            vec!["time_unit = \"iso\"", "unit = \"mm/s^2\""],
            true,
        ),
        (
            "uhr.csv",
            // The first midnight is passed.
            "Uhrzeit;Beschleunigung [mm/s\u{b2}]\n".to_owned()
                + &rows(|k| {
                    let (day, second) = (if k < 2000 { "23:59" } else { "0:00" }, (k + 58_000) % 60_000);
                    comma(format!("{day}:{:06.3};{:.5}\n", ms(second), decay(ms(k))))
                }),
            vec!["time_unit = \"iso\"", "decimal = \",\""],
            true,
        ),
        (
            "logger.csv",
            "time,accel_x_mm_s2\n".to_owned()
                + &rows(|k| format!("2024-05-03 12:01:{:06.3},{:.5}\n", ms(k), decay(ms(k)))),
            vec!["time_unit = \"iso\"", "unit = \"mm/s^2\""],
            true,
        ),
        (
            "datum.csv",
            "Zeit;Beschleunigung [g]\n".to_owned()
                + &rows(|k| {
                    let cells = comma(format!("{:06.3};{:.5}\n", ms(k), decay(ms(k))));
                    format!("03.05.2024 12:01:{cells}")
                }),
            vec!["time_unit = \"dmy\"", "unit = \"g\""],
            true,
        ),
        (
            "slashes.csv",
            "time,accel_x_g\n".to_owned()
                + &rows(|k| format!("2024/05/03 12:01:{:06.3},{:.5}\n", ms(k), decay(ms(k)))),
            vec!["time_unit = \"iso\""],
            true,
        ),
        (
            "american.csv",
            // The first day fits both orders, the next one only that with the month first.
            "time,accel_x_g\n".to_owned()
                + &rows(|k| {
                    let (day, half) = (if k < 500 { "12" } else { "13" }, if k < 500 { "PM" } else { "AM" });
                    let (clock, second) = (if k < 500 { "11:59" } else { "12:00" }, (k + 59_500) % 60_000);
                    format!("05/{day}/2024 {clock}:{:06.3} {half},{:.5}\n", ms(second), decay(ms(k)))
                }),
            vec!["time_unit = \"mdy\""],
            true,
        ),
        (
            "commented.csv",
            "# machine 4\n# time_s, tipAccel_g\n".to_owned()
                + &rows(|k| {
                    format!(
                        "{},{:.5}\n{}",
                        ms(k),
                        decay(ms(k)),
                        if k == 7 { "# knocked\n" } else { "" }
                    )
                }),
            vec!["comment = \"#\"", "time = \"time_s\"", "unit = \"g\""],
            true,
        ),
        (
            "bare.csv",
            rows(|k| format!("{}\t{:.5}\n", ms(k), decay(ms(k)))),
            vec!["header = false", "column = \"2\"", "# guessed"],
            false,
        ),
        (
            "millis.csv",
            "time,accel\n".to_owned() + &rows(|k| format!("{k},{:.5}\n", decay(ms(k)))),
            vec!["time_unit = \"ms\"  # guessed"],
            false,
        ),
    ]
}

#[test]
fn each_form_is_proposed_read_and_identified() {
    for (name, text, lines, certain) in forms() {
        let folder = write(name, &text);
        let inspected = json("inspect", Path::new(name), &folder);
        let manifest = std::fs::read_to_string(folder.path().join("recording.toml")).unwrap();
        for line in lines {
            assert!(manifest.contains(line), "{name}: no {line:?} in {manifest}");
        }
        let open = inspected["proposal"]["not_certain"].as_array().unwrap();
        assert_eq!(open.is_empty(), certain, "{name}: {open:?}");
        let channel = &inspected["channels"][0];
        assert!(
            (channel["rate_hz"].as_f64().unwrap() - 1000.0).abs() < 1e-3,
            "{name}: {channel}"
        );
        assert!(
            channel["start_s"].as_f64().unwrap() < 60.0,
            "{name}: {channel}"
        );
        let found = json("identify", Path::new("recording.toml"), &folder);
        let mode = &found["recordings"][0]["modes"][0];
        assert!(
            (mode["frequency_hz"].as_f64().unwrap() - 8.0).abs() < 1e-3,
            "{name}: {mode}"
        );
        assert!(
            (mode["damping_ratio"].as_f64().unwrap() - 0.02).abs() < 1e-4,
            "{name}: {mode}"
        );
        let mut command = Command::cargo_bin("quell").unwrap();
        let run = command
            .current_dir(folder.path())
            .args(["identify", name, "--out", "other"])
            .assert();
        if certain {
            run.success();
        } else {
            let run = run.code(2);
            let stderr = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
            assert!(
                stderr.contains(&format!("quell inspect {name}")),
                "{name}: {stderr}"
            );
        }
    }
}

#[test]
fn several_tests_of_one_file_are_several_recordings() {
    let one = |test: usize| {
        rows(|k| {
            format!(
                "{test},{},{:.5}\n",
                k as f64 / 1000.0,
                decay(k as f64 / 1000.0)
            )
        })
    };
    let text = "test,time_s,accel_g\n".to_owned() + &one(1) + &one(2) + &one(3);
    let folder = write("tests.csv", &text);
    let inspected = json("inspect", Path::new("tests.csv"), &folder);
    assert_eq!(
        inspected["proposal"]["manifests"].as_array().unwrap().len(),
        3
    );
    for name in ["recording.toml", "tests_2.toml", "tests_3.toml"] {
        let read = json("inspect", Path::new(name), &folder);
        assert_eq!(read["channels"][0]["samples"], 4000, "{name}");
    }
}

#[test]
fn an_error_shows_no_file_and_a_users_manifest_stays() {
    let secret = "secret".repeat(40);
    let text = format!("time_s,accel_g\n0,1\n0.001,{secret}\n0.002,1\n");
    let folder = write("run.csv", &text);
    let manifest = "name = \"mine\"\n[[channel]]\nrole = \"tip_acceleration\"\nfile = \"run.csv\"\ntime = \"time_s\"\n\
                    column = \"accel_g\"\nunit = \"g\"\n";
    std::fs::write(folder.path().join("recording.toml"), manifest).unwrap();
    for path in ["recording.toml", "run.csv"] {
        let mut command = Command::cargo_bin("quell").unwrap();
        let run = command
            .current_dir(folder.path())
            .args(["identify", path])
            .assert()
            .code(2);
        let stderr = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        assert!(!stderr.contains(&secret), "{path}: {stderr}");
        assert!(stderr.lines().count() < 4, "{path}: {stderr}");
    }
    let plain =
        "time_s,accel_g\n".to_owned() + &rows(|k| format!("{},{}\n", k as f64 / 1000.0, k % 7));
    std::fs::write(folder.path().join("run.csv"), plain).unwrap();
    json("inspect", Path::new("run.csv"), &folder);
    assert_eq!(
        std::fs::read_to_string(folder.path().join("recording.toml")).unwrap(),
        manifest
    );
    assert!(folder.path().join("run.toml").exists());
}

/// Text that is not UTF-8 is read as ISO 8859-1, where it can be; a drive's trace has demand and actual value.
#[test]
fn a_trace_of_a_drive_and_an_older_code_of_letters_are_understood() {
    let head = "Zeit [s];Beschleunigung [m/s\u{b2}]\n".to_owned();
    let text =
        head + &rows(|k| format!("{:.3};{:.5}\n", k as f64 / 1000.0, decay(k as f64 / 1000.0)));
    let folder = TempDir::new().unwrap();
    let bytes: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
    std::fs::write(folder.path().join("messung.csv"), bytes).unwrap();
    let told = json("identify", Path::new("messung.csv"), &folder);
    let hertz = told["recordings"][0]["modes"][0]["frequency_hz"]
        .as_f64()
        .unwrap();
    assert!((hertz / 8.0 - 1.0).abs() < 1e-3, "{hertz}");

    let head = "Time (s),Position demand (deg),Position actual (deg),Motor current (A),Following error (deg)\n".to_owned();
    let line = |k: usize| {
        let (t, x) = (k as f64 / 1000.0, decay(k as f64 / 1000.0));
        format!(
            "{t:.3},{x:.4},{:.4},{:.4},{:.4}\n",
            0.9 * x,
            3.0 * x,
            0.1 * x
        )
    };
    let folder = write("servo.csv", &(head + &rows(line)));
    json("inspect", Path::new("servo.csv"), &folder);
    let manifest = std::fs::read_to_string(folder.path().join("recording.toml")).unwrap();
    let roles: Vec<&str> = manifest.split("[[channel]]").skip(1).collect();
    for (channel, role, column) in [
        (roles[0], "command_position", "Position demand (deg)"),
        (roles[1], "motor_position", "Position actual (deg)"),
        (roles[2], "motor_current", "Motor current (A)"),
    ] {
        assert!(
            channel.contains(&format!("role = \"{role}\"")),
            "{manifest}"
        );
        assert!(
            channel.contains(&format!("column = \"{column}\"")),
            "{manifest}"
        );
    }
}

#[test]
fn a_cell_that_is_no_number_is_named_with_its_line() {
    for cell in ["ERR", "inf"] {
        let line = |k: usize| match k {
            50 => format!("{},{cell}\n", k as f64 / 1000.0),
            _ => format!("{},{:.5}\n", k as f64 / 1000.0, decay(k as f64 / 1000.0)),
        };
        let folder = write("run.csv", &("time_s,acc_g\n".to_owned() + &rows(line)));
        let proposal = &json("inspect", Path::new("run.csv"), &folder)["proposal"];
        let open = proposal["not_certain"].to_string();
        assert!(
            open.contains(cell) && open.contains("line 52") && open.contains("acc_g"),
            "{open}"
        );
        let text = proposal["manifests"][0]["text"].as_str().unwrap();
        assert!(text.contains("role = \"tip_acceleration\""), "{text}");
    }
    // The usual null of a data base is a sample that is missing.
    let line = |k: usize| match k {
        50 => "0.05,NULL\n".into(),
        _ => format!("{},{:.5}\n", k as f64 / 1000.0, decay(k as f64 / 1000.0)),
    };
    let folder = write("run.csv", &("time_s,acc_g\n".to_owned() + &rows(line)));
    json("identify", Path::new("run.csv"), &folder);
    // A last line that is cut off has its own number.
    let mut text = "time_s,acc_g\n".to_owned()
        + &rows(|k| format!("{},{:.5}\n", k as f64 / 1000.0, decay(k as f64 / 1000.0)));
    let lines = text.lines().count();
    text += "9.9";
    let folder = write("run.csv", &text);
    let mut command = Command::cargo_bin("quell").unwrap();
    let command = command
        .current_dir(folder.path())
        .args(["identify", "run.csv"]);
    let stderr = command.assert().code(2).get_output().stderr.clone();
    let stderr = String::from_utf8_lossy(&stderr).into_owned();
    assert!(
        stderr.contains(&format!("run.csv:{}", lines + 1)),
        "{stderr}"
    );
}

#[test]
fn columns_without_names_get_blocks_to_fill_in() {
    let line = |k: usize| {
        format!(
            "{},{:.5},{},{}\n",
            k as f64 / 1000.0,
            decay(k as f64 / 1000.0),
            k % 7,
            k % 5
        )
    };
    let folder = write("run.csv", &("t,x,y,z\n".to_owned() + &rows(line)));
    let found = json("inspect", Path::new("run.csv"), &folder);
    let text = found["proposal"]["manifests"][0]["text"].as_str().unwrap();
    assert_eq!(
        text.matches("# [[channel]]\n# role = \"\"\n").count(),
        3,
        "{text}"
    );
    assert!(
        found["proposal"]["not_certain"]
            .to_string()
            .contains("fill in"),
        "{found}"
    );
    let filled = text
        .replace(
            "# [[channel]]\n# role = \"\"",
            "[[channel]]\nrole = \"deformation\"",
        )
        .replace("# file", "file")
        .replace("# time", "time")
        .replace("# column", "column")
        .replace("# unit = \"\"", "unit = \"mm\"");
    let one = filled
        .split("\n[[channel]]")
        .take(2)
        .collect::<Vec<_>>()
        .join("\n[[channel]]");
    std::fs::write(folder.path().join("recording.toml"), one).unwrap();
    json("identify", Path::new("recording.toml"), &folder);
}

#[test]
fn utf_16_is_read_and_a_spectrum_of_klippers_is_refused() {
    let text = "Zeit;a [g]\n".to_owned()
        + &rows(|k| {
            format!("{:.3};{:.5}\n", k as f64 / 1000.0, decay(k as f64 / 1000.0)).replace('.', ",")
        });
    for mark in [0xfeff_u16.to_le_bytes(), 0xfeff_u16.to_be_bytes()] {
        let swap = mark == 0xfeff_u16.to_be_bytes();
        let units = text.encode_utf16().map(|unit| {
            if swap {
                unit.to_be_bytes()
            } else {
                unit.to_le_bytes()
            }
        });
        let bytes: Vec<u8> = mark.into_iter().chain(units.flatten()).collect();
        let folder = write("run.csv", "");
        std::fs::write(folder.path().join("run.csv"), bytes).unwrap();
        json("identify", Path::new("run.csv"), &folder);
    }
    for head in [
        "freq,psd_x,psd_y,psd_z,psd_xyz",
        "freq,psd_x,psd_y,psd_z,psd_xyz,zv(57.8),mzv(34.8)",
    ] {
        let cells = ",1.5e3".repeat(head.matches(',').count());
        let folder = write(
            "resonances_x_1.csv",
            &(head.to_owned() + "\n" + &rows(|k| format!("{k}{cells}\n"))),
        );
        let mut command = Command::cargo_bin("quell").unwrap();
        let command = command
            .current_dir(folder.path())
            .args(["identify", "resonances_x_1.csv"]);
        let stderr = command.assert().code(2).get_output().stderr.clone();
        let stderr = String::from_utf8_lossy(&stderr).into_owned();
        assert!(stderr.contains("raw_data_x_"), "{stderr}");
    }
}

/// The blocks of a proposed manifest, without their file and clock.
fn proposed(header: &str, columns: usize) -> Vec<String> {
    let line = |k: usize| {
        let cells: String = (0..columns)
            .map(|c| format!(",{}", (k * (c + 3)) % 17))
            .collect();
        format!("{:.3}{cells}\n", k as f64 / 100.0)
    };
    let folder = write("joints.csv", &(format!("time,{header}\n") + &rows(line)));
    json("inspect", Path::new("joints.csv"), &folder);
    let manifest = std::fs::read_to_string(folder.path().join("recording.toml")).unwrap();
    manifest
        .split("[[channel]]")
        .skip(1)
        .map(String::from)
        .collect()
}

/// Columns whose names differ in a number, or in words, are joints, where what moves has such names.
#[test]
fn numbers_and_words_in_names_are_joints() {
    let joint = |block: &String| {
        let line = block.lines().find(|line| line.starts_with("joint = "));
        line.and_then(|line| line.split('"').nth(1))
            .map(String::from)
    };
    for (header, joints, roles) in [
        (
            "motor_position_1_deg,motor_position_2_deg,torque_1,torque_2",
            ["1", "2", "1", "2"],
            ["motor_position", "motor_position", "torque", "torque"],
        ),
        (
            "q1,q2,tau1,tau2",
            ["1", "2", "1", "2"],
            ["motor_position", "motor_position", "torque", "torque"],
        ),
        (
            "joint1.position,joint1.velocity,joint1.effort,joint2.position",
            ["1", "1", "1", "2"],
            [
                "motor_position",
                "motor_velocity",
                "torque",
                "motor_position",
            ],
        ),
        (
            "observation.state_0,observation.state_1,action_0,action_1",
            ["0", "1", "0", "1"],
            [
                "motor_position",
                "motor_position",
                "command_position",
                "command_position",
            ],
        ),
        (
            "shoulder_position_rad,elbow_position_rad,shoulder_torque_Nm,elbow_torque_Nm",
            ["shoulder", "elbow", "shoulder", "elbow"],
            ["motor_position", "motor_position", "torque", "torque"],
        ),
        (
            "observation.state.shoulder_pan.pos,observation.state.wrist_roll.pos,action.shoulder_pan.pos,action.wrist_roll.pos",
            ["shoulder_pan", "wrist_roll", "shoulder_pan", "wrist_roll"],
            [
                "motor_position",
                "motor_position",
                "command_position",
                "command_position",
            ],
        ),
    ] {
        let blocks = proposed(header, 4);
        let told: Vec<_> = blocks.iter().map(joint).collect();
        let joints: Vec<_> = joints.iter().map(|joint| Some(joint.to_string())).collect();
        assert_eq!(told, joints, "{header}: {blocks:?}");
        for (block, role) in blocks.iter().zip(roles) {
            assert!(block.contains(&format!("role = \"{role}\"")), "{block}");
        }
    }
    // One joint has no number to be told from, and sensors beside a joint are none.
    for header in [
        "motor_position_1,torque_1",
        "motor_position,accel_1,accel_2",
        "position_deg,position_error_deg,target_position_deg",
        "raw_position_deg,filtered_position_deg,motor_current_A",
        "motor_position_rad,load_position_rad,torque_Nm",
    ] {
        let blocks = proposed(header, header.split(',').count());
        assert!(
            blocks.iter().all(|block| joint(block).is_none()),
            "{header}: {blocks:?}"
        );
    }
}

#[test]
fn each_joint_of_a_file_is_inspected_and_one_is_identified() {
    let head =
        "time,motor_position_1_deg,motor_position_2_deg,link_position_1_deg,link_position_2_deg\n";
    let line = |k: usize| {
        let time = k as f64 / 1000.0;
        format!(
            "{time:.3},0,0,{:.6},{:.6}\n",
            decay(time),
            decay(1.5 * time)
        )
    };
    let folder = write("joints.csv", &(head.to_owned() + &rows(line)));
    let quell = |arguments: &[&str]| {
        let mut command = Command::cargo_bin("quell").unwrap();
        command.current_dir(folder.path()).args(arguments);
        command.output().unwrap()
    };
    let refused = String::from_utf8(quell(&["identify", "joints.csv"]).stderr).unwrap();
    assert!(
        refused.contains("there are 2: 1, 2; take one as joints.csv#1"),
        "{refused}"
    );
    // Of names that are less certain the joints are told beside what is open.
    let unclear = rows(|k| format!("{:.3},{k},{k}\n", k as f64 / 1000.0));
    std::fs::write(
        folder.path().join("unclear.csv"),
        format!("time,q1,q2\n{unclear}"),
    )
    .unwrap();
    let refused = String::from_utf8(quell(&["identify", "unclear.csv"]).stderr).unwrap();
    assert!(
        refused.contains("it has the joints 1, 2: take one as recording.toml#1"),
        "{refused}"
    );
    let all = json("inspect", Path::new("joints.csv"), &folder);
    let joint = |k: usize| &all["joints"][k];
    assert_eq!([&joint(0)["joint"], &joint(1)["joint"]], ["1", "2"]);
    assert_eq!(joint(1)["channels"][0]["role"], "motor_position");
    let told = String::from_utf8(quell(&["inspect", "recording.toml"]).stdout).unwrap();
    assert!(
        told.contains("Joint 1 of joints\n") && told.contains("Joint 2 of joints\n"),
        "{told}"
    );
    assert!(
        told.ends_with("Next: quell identify 'recording.toml#1'\n"),
        "{told}"
    );
    for source in ["joints.csv#2", "recording.toml#2"] {
        let found = json("identify", Path::new(source), &folder);
        let text = found.to_string();
        let hertz = &found["recommended"]["modes"][0]["frequency_hz"];
        let hertz = hertz
            .as_f64()
            .or(found["recordings"][0]["modes"][0]["frequency_hz"].as_f64());
        assert!((hertz.unwrap_or(0.0) / 12.0 - 1.0).abs() < 1e-2, "{text}");
    }
}

#[test]
fn german_and_french_headers_are_understood() {
    for (header, roles) in [
        (
            "Zeit;Motorposition [deg];Drehmoment [Nm];Strom [A];Geschwindigkeit [rad/s]",
            [
                "motor_position",
                "torque",
                "motor_current",
                "motor_velocity",
            ],
        ),
        (
            "temps;position moteur [rad];couple [Nm];courant [A];vitesse [rad/s]",
            [
                "motor_position",
                "torque",
                "motor_current",
                "motor_velocity",
            ],
        ),
    ] {
        let line = |k: usize| {
            let x = decay(k as f64 / 1000.0);
            format!(
                "{:.3};{x:.4};{:.4};{:.4};{:.4}\n",
                k as f64 / 1000.0,
                2.0 * x,
                3.0 * x,
                4.0 * x
            )
        };
        let folder = write("werte.csv", &(format!("{header}\n") + &rows(line)));
        json("inspect", Path::new("werte.csv"), &folder);
        let manifest = std::fs::read_to_string(folder.path().join("recording.toml")).unwrap();
        let told = manifest
            .lines()
            .filter_map(|line| line.strip_prefix("role = \""));
        let told: Vec<_> = told.filter_map(|role| role.split('"').next()).collect();
        assert_eq!(told, roles, "{manifest}");
    }
}

//! CSV files as loggers write them: rows of units, clocks that begin again or repeat, axes in any order.

mod verb;

use serde_json::Value;
use std::f64::consts::TAU;
use std::fmt::Write;
use tempfile::TempDir;
use verb::{has, quell};

/// A decay of 8 Hz with a damping ratio of 0.02 after a rest of a second.
fn decay(hertz: f64, time: f64) -> f64 {
    let (w, t) = (TAU * hertz, time - 1.0);
    match t < 0.0 {
        true => 0.0,
        false => (-0.02 * w * t).exp() * (w * t).sin(),
    }
}

/// A file of 4000 rows at 1 kHz under a header.
fn file(name: &str, header: &str, row: impl Fn(f64) -> String) -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut text = format!("{header}\n");
    for k in 0..4000 {
        writeln!(text, "{}", row(f64::from(k) / 1000.0)).unwrap();
    }
    std::fs::write(folder.path().join(name), text).unwrap();
    folder
}

/// The proposed manifest.
fn proposed(folder: &TempDir, name: &str) -> String {
    quell(folder, &["inspect", name]);
    std::fs::read_to_string(folder.path().join("recording.toml")).unwrap()
}

#[test]
fn a_row_of_units_below_the_names_is_read() {
    // Blank cells at the ends of the lines, and as many decimal commas as separators.
    let comma = |value: f64| format!("{value:.4}").replace('.', ",");
    let row = |t: f64| {
        format!(
            "{};{};{};",
            comma(t),
            comma(2.0 * t),
            comma(2.0 * t + decay(8.0, t))
        )
    };
    let folder = file(
        "messung.csv",
        "Zeit;Motorwinkel;Abtriebswinkel;\ns;°;°;",
        row,
    );
    let manifest = proposed(&folder, "messung.csv");
    has(
        &manifest,
        &[
            "delimiter = \";\"",
            "role = \"motor_position\"\nfile = \"messung.csv\"\ntime = \"1\"\ncolumn = \"2\"",
            "role = \"link_position\"\nfile = \"messung.csv\"\ntime = \"1\"\ncolumn = \"3\"",
            "unit = \"deg\"",
        ],
    );
    assert!(!manifest.contains("deformation"), "{manifest}");

    // A share of the nominal torque is no torque in N.m.
    let row = |t: f64| {
        format!(
            "{:.0};{:.4};{:.4}",
            1000.0 * t,
            decay(8.0, t),
            3.0 * decay(8.0, t)
        )
    };
    let folder = file(
        "drive.csv",
        "Time;Actual position;Actual torque\nms;deg;%",
        row,
    );
    let manifest = proposed(&folder, "drive.csv");
    let torque = manifest
        .split("[[channel]]")
        .find(|own| own.contains("\"torque\""));
    has(
        torque.unwrap(),
        &[
            "unit = \"raw\"  # guessed: % of a nominal value; for N.m write unit = \"N.m\" and scale = the nominal value",
        ],
    );
    has(&manifest, &["time_unit = \"ms\"", "unit = \"deg\""]);
}

#[test]
fn a_time_that_begins_again_makes_a_recording_of_each_part() {
    let again = |t: f64| {
        format!(
            "{:.3},{:.5}",
            if t < 2.0 { t } else { t - 2.0 },
            decay(8.0, t % 2.0 + 0.9)
        )
    };
    let folder = file("two.csv", "time_s,accel_g", again);
    let manifest = proposed(&folder, "two.csv");
    has(&manifest, &["rows = [0, 2000]"]);
    for name in ["recording.toml", "two_2.toml"] {
        let told = quell(&folder, &["identify", "--json", "--force", name]).0;
        let told: Value = serde_json::from_str(&told).unwrap();
        let hertz = told["recordings"][0]["modes"][0]["frequency_hz"]
            .as_f64()
            .unwrap();
        assert!((hertz / 8.0 - 1.0).abs() < 1e-3, "{name}: {hertz}");
    }
    has(
        &quell(&folder, &["identify", "two.csv"]).1,
        &["it has 2 tests"],
    );
    // Within the rows of a manifest the time must still advance.
    let wide = manifest.replace("[0, 2000]", "[0, 2001]");
    std::fs::write(folder.path().join("recording.toml"), wide).unwrap();
    has(
        &quell(&folder, &["identify", "recording.toml"]).1,
        &["two.csv:2002", "time runs backwards"],
    );
}

#[test]
fn a_stamp_that_repeats_is_told_with_what_to_do() {
    let rounded = |t: f64| format!("{:.2},{:.5}", t, decay(8.0, t));
    let folder = file("run.csv", "time_s,accel_g", rounded);
    has(
        &quell(&folder, &["identify", "run.csv"]).1,
        &["stands twice", "rate_hz", "about 1000 samples a second"],
    );
    let twice = |t: f64| {
        let row = format!("{t:.3},{:.5}", decay(8.0, t));
        if (t - 0.7).abs() < 1e-6 {
            format!("{row}\n{row}")
        } else {
            row
        }
    };
    let folder = file("run.csv", "time_s,accel_g", twice);
    has(
        &quell(&folder, &["identify", "run.csv"]).1,
        &["0.7 stands twice", "1 line repeats the line above"],
    );
}

#[test]
fn modes_are_told_along_the_axes_that_the_file_names() {
    let row = |t: f64| {
        format!(
            "{t:.3},9.81,{:.5},{:.5}",
            decay(31.0, t),
            5.0 * decay(42.0, t)
        )
    };
    let folder = file("zyx.csv", "time_s,accel_z,accel_y,accel_x", row);
    has(
        &quell(&folder, &["identify", "zyx.csv"]).0,
        &["Hz along x, 31", "Hz along y."],
    );
    // A phone's file says by its name what its columns are.
    let folder = file("Accelerometer.csv", "time,seconds_elapsed,z,y,x", |t| {
        format!(
            "{:.0},{t:.3},0.01,{:.5},{:.5}",
            1.7e18 + 1e9 * t,
            decay(31.0, t),
            5.0 * decay(42.0, t)
        )
    });
    has(
        &quell(&folder, &["identify", "Accelerometer.csv"]).0,
        &["Hz along x, 31", "Hz along y."],
    );
    let row = |t: f64| format!("{t:.3},{:.5},{:.5}", decay(31.0, t), 5.0 * decay(42.0, t));
    let folder = file("yz.csv", "time_s,accel_y,accel_z", row);
    has(
        &quell(&folder, &["identify", "yz.csv"]).0,
        &["Hz along z, 31", "Hz along y."],
    );
    // Two accelerometers are no axes of one: neither is left out unasked.
    let folder = file("two.csv", "time_s,accel_1 (g),accel_2 (g)", row);
    has(
        &quell(&folder, &["identify", "two.csv"]).1,
        &["which column is the tip_acceleration, of accel_1 (g), accel_2 (g)"],
    );
}

/// Rates and angles about the axes of an accelerometer are of one body: three joints `x`, `y` and `z` they are not.
#[test]
fn axes_of_an_accelerometer_are_known_by_the_names_of_programs_or_by_gravity() {
    let of = |t: f64, unit: f64| {
        let [x, y, z] = [5.0 * decay(42.0, t), decay(31.0, t), 9.80665].map(|a| a / unit);
        format!("{x:.5},{y:.5},{z:.5}")
    };
    let g = 9.80665;
    for (header, unit, words) in [
        ("time,gFx,gFy,gFz,wx,wy,wz", g, "unit = \"g\"\n"),
        (
            "time,AcX,AcY,AcZ,GyX,GyY,GyZ",
            g / 16384.0,
            "unit = \"raw\"",
        ),
        (
            "\"Time\",\"X (100g)\",\"Y (100g)\",\"Z (100g)\"",
            g,
            "unit = \"g\"\n",
        ),
        ("time_s,x_ms2,y_ms2,z_ms2", 1.0, "unit = \"m/s^2\"\n"),
        (
            "time_s,linear_acceleration.x,linear_acceleration.y,linear_acceleration.z,\
             angular_velocity.x,angular_velocity.y,angular_velocity.z",
            1.0,
            "its mean is the gravity",
        ),
        (
            "time_s,ax(g),ay(g),az(g),wx(deg/s),wy(deg/s),wz(deg/s),AngleX(deg),AngleY(deg),AngleZ(deg)",
            g,
            "unit = \"g\"\n",
        ),
        (
            "time_s,one,two,three",
            1.0,
            "role = \"tip_acceleration\"  # guessed: its mean",
        ),
    ] {
        let others = header.split(',').count() - 4;
        let row = |t: f64| format!("{t:.4},{}{}", of(t, unit), ",0.25".repeat(others));
        let folder = file("log.csv", header, row);
        let manifest = proposed(&folder, "log.csv");
        has(&manifest, &["role = \"tip_acceleration\"", words]);
        let blocks = manifest.matches("[[channel]]").count();
        assert!(blocks == 1 && !manifest.contains("joint ="), "{manifest}");
        has(
            &quell(&folder, &["identify", "log.csv"]).0,
            &["Hz along x, 31", "Hz along y."],
        );
    }
    // Copied from the serial monitor of Arduino, with its stamps.
    let line = |t: f64| format!("10:00:{t:06.3} -> {}", of(t, 1.0));
    for header in ["", "10:00:00.000 -> ax,ay,az"] {
        let folder = file("serial.txt", header, line);
        has(
            &quell(&folder, &["identify", "serial.txt"]).0,
            &["Hz along x, 31", "Hz along y."],
        );
    }
}

#[test]
fn counts_of_encoders_and_the_q_beside_a_theta_are_known() {
    let row = |t: f64| {
        format!(
            "{t:.3},{:.0},{:.0}",
            900.0 * t,
            900.0 * t + 50.0 * decay(8.0, t)
        )
    };
    for header in [
        "Time (s),MotorPos (cnt),LoadPos (cnt)",
        "time_s,motor_pos_inc,load_pos_inc",
    ] {
        let folder = file("servo.csv", header, row);
        let manifest = proposed(&folder, "servo.csv");
        assert_eq!(
            manifest.matches("unit = \"count\"").count(),
            2,
            "{manifest}"
        );
        has(
            &manifest,
            &["role = \"motor_position\"", "role = \"link_position\""],
        );
    }
    let folder = file("lab.csv", "t,q1,q2,theta1,theta2", |t| {
        let (u, y) = (t, t + decay(8.0, t));
        format!("{t:.3},{y:.5},{y:.5},{u:.5},{u:.5}")
    });
    let manifest = proposed(&folder, "lab.csv");
    let blocks: Vec<&str> = manifest.split("[[channel]]").skip(1).collect();
    for (block, role, column) in [(0, "link", "q1"), (2, "motor", "theta1")] {
        has(
            blocks[block],
            &[
                &format!("role = \"{role}_position\""),
                &format!("column = \"{column}\""),
            ],
        );
    }
}

#[test]
fn a_length_that_follows_a_motors_angle_is_no_deformation() {
    let row = |t: f64| {
        format!(
            "{t:.3},{:.3},{:.4}",
            300.0 * t.min(2.0),
            300.0 / 18.0 * t.min(2.0) + 0.4 * decay(8.0, t)
        )
    };
    let folder = file("axis.csv", "time_s,motor_deg,tool_mm", row);
    let manifest = proposed(&folder, "axis.csv");
    assert!(!manifest.contains("deformation"), "{manifest}");
    has(
        &quell(&folder, &["identify", "axis.csv"]).1,
        &[
            "how many mm \"tool_mm\" goes for each deg of \"motor_deg\"",
            "about 0.055",
            "unit = \"mm\"",
        ],
    );
}

#[test]
fn an_elapsed_time_is_a_time() {
    let folder = file("laser.csv", "No.,Elapsed,OUT1(mm)", |t| {
        format!("{:.0},{t:.3},{:.4}", 1000.0 * t, 150.0 + decay(8.0, t))
    });
    has(
        &proposed(&folder, "laser.csv"),
        &["time = \"Elapsed\"", "column = \"OUT1(mm)\""],
    );
}

#[test]
fn numbers_that_stand_for_missing_samples_are_none() {
    let row = |t: f64| match (1000.0 * t).round() as u32 % 371 {
        5 => format!("{t:.3},-9999.00"),
        _ => format!("{t:.3},{:.5}", decay(8.0, t)),
    };
    let folder = file("run.csv", "time_s,accel_g", row);
    has(
        &proposed(&folder, "run.csv"),
        &["missing = [\"-9999.00\"]  # guessed"],
    );
    has(&quell(&folder, &["identify", "run.csv"]).0, &["1     8.00"]);
}

#[test]
fn rows_of_several_sensors_in_turn_are_no_one_signal() {
    let row = |t: f64| {
        format!(
            "{t:.4},motor,{t:.4}\n{:.4},link,{:.4}",
            t + 5e-4,
            t + decay(8.0, t)
        )
    };
    let folder = file("long.csv", "time_s,sensor,value", row);
    has(
        &quell(&folder, &["identify", "long.csv"]).1,
        &[
            "several sensors in turn, \"sensor\" has link, motor",
            "csv = { only = { \"sensor\" = \"link\" } }",
        ],
    );
    // A state that lasts, and rows that have the one or the other value, are no reason to ask.
    let row = |t: f64| {
        format!(
            "{t:.3},{},{:.4}",
            if t < 2.0 { "idle" } else { "on" },
            decay(8.0, t)
        )
    };
    let folder = file("state.csv", "time_s,state_name,accel_g", row);
    has(
        &quell(&folder, &["identify", "state.csv"]).0,
        &["Recommended: "],
    );
    let row = |t: f64| {
        format!(
            "{t:.4},{:.4},\n{:.4},,{:.4}",
            20.0 * t.min(1.0),
            t + 5e-4,
            20.0 * t.min(1.0) + decay(8.0, t)
        )
    };
    let folder = file("sparse.csv", "time_s,motor_deg,link_deg", row);
    has(
        &quell(&folder, &["identify", "sparse.csv"]).0,
        &["Recommended: "],
    );
}

#[test]
fn lines_below_the_table_and_a_preamble_with_tabs_are_told_apart_from_it() {
    let folder = file("run.csv", "time_s,accel_g", |t| match t < 3.9985 {
        true => format!("{t:.3},{:.5}", decay(8.0, t)),
        false => "Min,-1.0\nMax,1.0".into(),
    });
    let said = quell(&folder, &["identify", "run.csv"]).1;
    has(&said, &["\"Min\" in line 4001"]);
    assert!(!said.contains("rate_hz"), "{said}");
    let head = "LabVIEW Measurement\nWriter_Version\t2\nSeparator\tTab\n***End_of_Header***\n\nChannels\t2\nSamples\t4000\t4000\n\
                X0\t0\t0\nDelta_X\t0.001\t0.001\n***End_of_Header***\nX_Value\tAcceleration_0\tAcceleration_1\tComment";
    let folder = file("run.lvm", head, |t| {
        format!("{t:.3}\t{:.5}\t{:.5}\t", decay(8.0, t), 0.3 * decay(8.0, t))
    });
    let manifest = proposed(&folder, "run.lvm");
    has(
        &manifest,
        &["delimiter = \"\\t\"", "column = \"Acceleration_0\""],
    );
}

#[test]
fn a_short_sweep_is_a_sweep() {
    // A mode of 23 Hz by a force that sweeps from 5 to 60 Hz in 4 s, by Euler's method with small steps.
    let (w, mut x, mut v) = (TAU * 23.0, 0.0, 0.0);
    let mut text = String::from("t_s,acc_g\n");
    let mut random = 1_u64;
    for k in 0..1600 * 50 {
        let t = f64::from(k) / 20_000.0;
        let force = (TAU * (5.0 * t + 55.0 / 8.0 * t * t)).sin();
        let a = force - 0.03 * w * v - w * w * x;
        if k % 50 == 0 {
            random = random
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let noise = (random >> 33) as f64 / f64::from(1 << 31) - 0.5;
            writeln!(text, "{t:.4},{:.4}", a + 0.1 * noise).unwrap();
        }
        v += a / 20_000.0;
        x += v / 20_000.0;
    }
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("sweep.csv"), text).unwrap();
    let told: Value =
        serde_json::from_str(&quell(&folder, &["identify", "--json", "sweep.csv"]).0).unwrap();
    let one = &told["recordings"][0];
    assert_eq!(one["excitation"], "sweep", "{one}");
    let modes = one["modes"].as_array().unwrap();
    assert!(
        modes.len() == 1 && (modes[0]["frequency_hz"].as_f64().unwrap() / 23.0 - 1.0).abs() < 0.01,
        "{one}"
    );
}

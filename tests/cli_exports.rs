//! CSV files as drives, scopes, robots and laboratory programs export them.

mod verb;

use serde_json::Value;
use std::f64::consts::{PI, TAU};
use tempfile::TempDir;
use verb::{has, quell};

/// Instants a second.
const RATE: f64 = 500.0;
/// Of the link.
const MODE: (f64, f64) = (6.0, 0.03);

/// A joint that goes forth and back by 1 with rests: instants, positions of motor side and link.
fn joint() -> Vec<[f64; 3]> {
    let (w, xi) = (TAU * MODE.0, MODE.1);
    // Each half of a move is a raised cosine of acceleration.
    let acceleration = |t: f64| match t % 2.0 {
        k if !(0.8..1.2).contains(&k) => 0.0,
        k => {
            let sign = if t % 4.0 < 2.0 { 1.0 } else { -1.0 };
            sign * 1.0 * TAU / 0.16 * (TAU * (k - 0.8) / 0.4).sin()
        }
    };
    let (steps, rows) = (20, 4000);
    let h = 1.0 / (RATE * f64::from(steps));
    let mut state = [0.0; 4];
    let mut out = Vec::new();
    for k in 0..rows * steps {
        let t = f64::from(k) * h;
        if k % steps == 0 {
            out.push([t, state[0], state[0] + state[2]]);
        }
        // The midpoint rule.
        let slope = |s: [f64; 4], a: f64| [s[1], a, s[3], -w * w * s[2] - 2.0 * xi * w * s[3] - a];
        let first = slope(state, acceleration(t));
        let middle = core::array::from_fn(|i| state[i] + 0.5 * h * first[i]);
        let second = slope(middle, acceleration(t + 0.5 * h));
        state = core::array::from_fn(|i| state[i] + h * second[i]);
    }
    out
}

/// A decay after an impact at 0.6 s.
fn tap(hertz: f64, ratio: f64, time: f64) -> f64 {
    let (w, t) = (TAU * hertz, time - 0.6);
    match t < 0.0 {
        true => 0.0,
        false => (-ratio * w * t).exp() * (w * (1.0 - ratio * ratio).sqrt() * t).sin(),
    }
}

fn written(name: &str, lines: impl IntoIterator<Item = String>) -> TempDir {
    let folder = TempDir::new().unwrap();
    let lines: Vec<String> = lines.into_iter().collect();
    std::fs::write(folder.path().join(name), lines.join("\r\n") + "\r\n").unwrap();
    folder
}

/// A folder with a joint's export, which has these lines above its rows.
fn exported(name: &str, head: &str, row: impl Fn([f64; 3]) -> String) -> TempDir {
    let lines = head.lines().map(String::from);
    written(name, lines.chain(joint().into_iter().map(row)))
}

/// What is told of a file, and the manifest proposed for it.
fn proposed(folder: &TempDir, name: &str) -> (String, String) {
    let told = quell(folder, &["inspect", name]).0;
    let manifest = std::fs::read_to_string(folder.path().join("recording.toml")).unwrap();
    (told, manifest)
}

/// The first mode that is identified in the proposed recording: from a joint, or from what vibrates alone.
fn mode(folder: &TempDir) -> (f64, f64) {
    let (told, error) = quell(folder, &["identify", "--json", "recording.toml"]);
    let told: Value = serde_json::from_str(&told).unwrap_or_else(|_| panic!("{error}"));
    let found = match told.get("recordings") {
        Some(all) => &all[0]["modes"][0],
        None => &told["recommended"]["modes"][0],
    };
    let figure = |key: &str| found[key].as_f64().unwrap_or_else(|| panic!("{told}"));
    (figure("frequency_hz"), figure("damping_ratio"))
}

fn is_near(found: (f64, f64), hertz: f64, ratio: f64) {
    assert!(
        (found.0 / hertz - 1.0).abs() < 3e-3,
        "{found:?}, not {hertz}"
    );
    assert!(
        (found.1 / ratio - 1.0).abs() < 0.1,
        "{found:?}, not {ratio}"
    );
}

#[test]
fn a_preamble_with_columns_of_its_own_is_none_of_the_table() {
    // LabVIEW writes values of each channel above their names; TwinCAT a block of lines, of which one has the names.
    let head = [
        "LabVIEW Measurement\t",
        "Writer_Version\t2",
        "Separator\tTab",
        "***End_of_Header***\t",
        "",
        "Channels\t2\t",
        "Samples\t3000\t3000\t",
        "Date\t2024/05/01\t2024/05/01\t",
        "X_Dimension\tTime\tTime\t",
        "X0\t0.0000000000000000E+0\t0.0000000000000000E+0\t",
        "Delta_X\t0.001000\t0.001000\t",
        "***End_of_Header***\t\t\t",
        "X_Value\tAcceleration\tVoltage\tComment",
    ];
    let row = |k: i32| {
        let t = f64::from(k) / 1000.0;
        format!("{t:.6}\t{:.6}\t{:.6}\t", tap(23.0, 0.02, t), 0.3 * t.sin())
    };
    let lines = head.map(String::from).into_iter().chain((0..3000).map(row));
    let folder = written("tap.lvm", lines);
    let (_, manifest) = proposed(&folder, "tap.lvm");
    has(
        &manifest,
        &[
            "skip = 12",
            "role = \"tip_acceleration\"",
            "column = \"Acceleration\"",
        ],
    );
    is_near(mode(&folder), 23.0, 0.02);

    let head = [
        "Name;YT Scope Project",
        "File;C:\\Scope\\move.svdx",
        "",
        "Name;Axis1.MotorPos;Name;Axis1.LoadPos",
        "SymbolComment;;SymbolComment;",
        "Data-Type;REAL64;Data-Type;REAL64",
        "SampleTime[ms];2;SampleTime[ms];2",
        "Offset;0;Offset;0",
        "BitMask;0xFFFF;BitMask;0xFFFF",
        "",
    ];
    let row = |[t, u, y]: [f64; 3]| {
        let t = 1e3 * t;
        format!("{t:.0};{:.5};{t:.0};{:.5}", 40.0 * u, 40.0 * y)
    };
    let lines = head
        .map(String::from)
        .into_iter()
        .chain(joint().into_iter().map(row));
    let folder = written("scope.csv", lines);
    let (_, manifest) = proposed(&folder, "scope.csv");
    has(
        &manifest,
        &[
            "skip = 10",
            "column = \"2\"  # Axis1.MotorPos",
            "column = \"4\"  # Axis1.LoadPos",
            "time_unit = \"ms\"",
        ],
    );
    is_near(mode(&folder), MODE.0, MODE.1);
}

#[test]
fn names_behind_the_mark_of_a_comment_may_have_spaces_between_them() {
    let row = |[t, u, y]: [f64; 3]| format!("  {t:1.7e}  {:1.7e}  {:1.7e}", u, y - u);
    let lines = std::iter::once("% t[s]  theta[rad]  alpha[rad]".to_string())
        .chain(joint().into_iter().map(row));
    let folder = written("srv02.txt", lines);
    let (told, manifest) = proposed(&folder, "srv02.txt");
    has(
        &manifest,
        &[
            "column = \"theta[rad]\"",
            "role = \"deformation\"  # guessed",
        ],
    );
    has(&told, &["whether \"alpha[rad]\" is a deformation"]);
    is_near(mode(&folder), MODE.0, MODE.1);
}

#[test]
fn subscripts_of_motor_and_link_are_no_units_and_durations_are_a_time() {
    let row = |[t, u, y]: [f64; 3]| format!("{t} sec,{u:.15},{y:.15}");
    let lines =
        std::iter::once("Time,theta_m,theta_l".to_string()).chain(joint().into_iter().map(row));
    let folder = written("timetable.csv", lines);
    let (_, manifest) = proposed(&folder, "timetable.csv");
    has(
        &manifest,
        &[
            "time = \"Time\"\ntime_unit = \"s\"",
            "role = \"motor_position\"",
            "role = \"link_position\"",
        ],
    );
    assert!(!manifest.contains("unit = \"m\""), "{manifest}");
    is_near(mode(&folder), MODE.0, MODE.1);
}

#[test]
fn inputs_of_a_scope_are_asked_for_with_their_sensors() {
    let row = |k: i32| {
        let t = f64::from(k) / 1000.0;
        format!("{t:.5E},{:.4E},{:.4E}", tap(31.0, 0.02, t), 5.0 * t)
    };
    for head in [
        "Source,CH1,CH2\r\nSecond,Volt,Volt",
        "Time (s),Channel A (V),Channel B (V)",
        "Time (s),Dev1/ai0 (V),Dev1/ai1 (V)",
        "Time,Ch1,Ch2",
    ] {
        let folder = written(
            "scope.csv",
            std::iter::once(head.to_string()).chain((0..3000).map(row)),
        );
        let (told, manifest) = proposed(&folder, "scope.csv");
        has(&told, &["with what its sensor measures"]);
        assert!(
            !manifest.contains("motor_voltage") && manifest.contains("# time = "),
            "{manifest}"
        );
    }
}

#[test]
fn axes_of_a_tool_are_of_no_joint_and_a_commanded_speed_is_not_measured() {
    let mut head: Vec<String> = vec!["timestamp".into()];
    for name in [
        "actual_q",
        "actual_current",
        "actual_TCP_pose",
        "actual_TCP_force",
    ] {
        head.extend((0..6).map(|k| format!("{name}_{k}")));
    }
    head.extend((0..3).map(|k| format!("actual_tool_accelerometer_{k}")));
    let row = |[t, u, y]: [f64; 3]| {
        let mut cells = vec![format!("{:.3}", 18_234.0 + t)];
        cells.extend((0..24).map(|k| format!("{:.6}", u * f64::from(k + 1))));
        cells.extend([0.5 * (y - u), 0.1 * (y - u), 9.81 + (y - u)].map(|a| format!("{a:.5}")));
        cells.join(" ")
    };
    let lines = std::iter::once(head.join(" ")).chain(joint().into_iter().map(row));
    let folder = written("robot.csv", lines);
    let (_, manifest) = proposed(&folder, "robot.csv");
    let blocks: Vec<&str> = manifest.split("[[channel]]").skip(1).collect();
    assert_eq!(blocks.len(), 13, "{manifest}");
    let tool = blocks
        .iter()
        .find(|block| block.contains("tip_acceleration"))
        .unwrap();
    has(
        tool,
        &[
            "actual_tool_accelerometer_0\", \"actual_tool_accelerometer_1\", \"actual_tool_accelerometer_2\"]",
        ],
    );
    assert!(!tool.contains("joint"), "{tool}");

    let row =
        |[t, u, _]: [f64; 3]| format!("{t:.6}\t{:.5}\t{u:.6}\t{:.4}", (PI * t).sin(), 2.0 * u);
    let head =
        "Time\tAxis 1 Speed ref\tAxis 1 Resolver angle\tAxis 1 Torque\r\n[s]\t[rad/s]\t[rad]\t[Nm]";
    let folder = exported("signals.csv", head, row);
    let (_, manifest) = proposed(&folder, "signals.csv");
    assert!(!manifest.contains("velocity"), "{manifest}");
}

#[test]
fn seconds_and_nanoseconds_beside_them_tell_the_rate() {
    let row = |k: i32| {
        let ns = i64::from(k) * 2_500_000;
        let a = tap(9.0, 0.02, f64::from(k) / 400.0);
        format!(
            "{},{},imu_link,0.0,0.0,{a:.6},0.0",
            1_714_554_842 + ns / 1_000_000_000,
            ns % 1_000_000_000
        )
    };
    let folder = written("imu.csv", (0..3000).map(row));
    let (told, manifest) = proposed(&folder, "imu.csv");
    has(
        &manifest,
        &["rate_hz = 400  # guessed: seconds stand in \"1\" and nanoseconds in \"2\""],
    );
    // What has one value throughout is not asked for, so that one column is left.
    has(&manifest, &["column = \"6\""]);
    assert!(!told.contains("rate_hz is needed"), "{told}");
}

#[test]
fn a_second_position_is_asked_for_and_a_velocity_of_another_kind_is_the_links() {
    let row = |[t, u, y]: [f64; 3]| format!("{t:.4},{:.0},{:.0}", 8e3 * u, 8e3 * y);
    let head = "Time (s),Position [cnt],Aux Position [cnt]";
    let folder = exported("servo.csv", head, row);
    let (told, _) = proposed(&folder, "servo.csv");
    has(
        &told,
        &[
            "what \"Aux Position [cnt]\" is beside \"Position [cnt]\"",
            "role = \"link_position\"",
        ],
    );

    let row = |[t, u, y]: [f64; 3]| format!("{t:.4},{u:.6},{:.6}", 300.0 * (y - u));
    let head = "Time [s],Motor angle [rad],Vib velocity [mm/s]";
    let folder = exported("vibrometer.csv", head, row);
    let (_, manifest) = proposed(&folder, "vibrometer.csv");
    has(&manifest, &["role = \"link_velocity\"  # guessed"]);
    is_near(mode(&folder), MODE.0, MODE.1);
}

#[test]
fn the_time_may_stand_beside_what_an_instrument_tells_of_itself() {
    let about = ["Record Length,2500", "Source,CH1", "Units,V"];
    let row = |k: usize| {
        let t = k as f64 / 1000.0;
        let first = about.get(k).copied().unwrap_or(",");
        format!("{first},{t:.9},{:.5},", tap(31.0, 0.02, t))
    };
    let folder = written("scope.csv", (0..3000).map(row));
    let (told, manifest) = proposed(&folder, "scope.csv");
    has(&told, &["column 3, whose values grow, has the time"]);
    has(&manifest, &["time = \"3\""]);
    // Stamps with a colon before the milliseconds, beside a counter of scans.
    let row = |k: i32| {
        let (s, ms) = (k / 100, 10 * (k % 100));
        format!(
            "{},05/14/2024 09:14:{s:02}:{ms:03},{:.6}",
            k + 1,
            tap(7.0, 0.02, f64::from(k) / 100.0)
        )
    };
    let lines = std::iter::once("Scan,Time,accel_g".to_string()).chain((0..2000).map(row));
    let folder = written("logger.csv", lines);
    let (_, manifest) = proposed(&folder, "logger.csv");
    has(&manifest, &["time = \"Time\"\ntime_unit = \"mdy\""]);
    is_near(mode(&folder), 7.0, 0.02);
}

/// A comma as the decimal mark.
fn comma(value: f64) -> String {
    format!("{value:.5}").replace('.', ",")
}

/// A joint's export with these lines above its rows: the mode that is identified in the proposed recording is its own.
fn is_read(name: &str, head: &str, row: impl Fn([f64; 3]) -> String, words: &[&str]) {
    let folder = exported(name, head, row);
    let (_, manifest) = proposed(&folder, name);
    has(&manifest, words);
    is_near(mode(&folder), MODE.0, MODE.1);
}

#[test]
fn units_in_brackets_may_be_german_or_counts_of_a_revolution() {
    is_read(
        "messung.csv",
        "Zeit [s];Motorwinkel [Grad];Abtriebswinkel [Grad]",
        |[t, u, y]| format!("{};{};{}", comma(t), comma(40.0 * u), comma(40.0 * y)),
        &["column = \"Motorwinkel [Grad]\"\nunit = \"deg\""],
    );
    is_read(
        "counts.csv",
        "t [s],motor pos [4096/rev],load pos [4096/rev]",
        |[t, u, y]| format!("{t:.3},{:.0},{:.0}", 12288.0 * u, 12288.0 * y),
        &["unit = \"rev\"\nscale = 0.000244140625  # 4096 counts a revolution"],
    );
    is_read(
        "drive.csv",
        "Time [ms];Motor position [deg];Load position [deg];Actual torque [%]",
        |[t, u, y]| format!("{:.0};{u:.6};{y:.6};{:.4}", 1e3 * t, 30.0 * (y - u)),
        &["for N.m write unit = \"N.m\" and scale = the nominal value in N.m / 100"],
    );
}

#[test]
fn names_of_drives_are_known_by_their_standard_or_their_language() {
    is_read(
        "antrieb.csv",
        "Zeit [ms];Drehzahlistwert [1/min];Drehzahlsollwert [1/min];Lageistwert Motor [°];Lageistwert Last [°]",
        |[t, u, y]| {
            format!(
                "{};0;{};{};{}",
                comma(1e3 * t),
                comma(t.sin()),
                comma(40.0 * u),
                comma(40.0 * y)
            )
        },
        &[
            "role = \"motor_velocity\"  # guessed: by the name \"Drehzahlistwert [1/min]\"",
            "unit = \"rpm\"",
            "role = \"link_position\"  # guessed: by the name \"Lageistwert Last [°]\"",
            "not used: Drehzahlsollwert",
        ],
    );
    // IndraWorks: the second encoder of a SERCOS drive is external.
    is_read(
        "oszilloskop.csv",
        "IndraWorks Oszilloskop\nDatum;12.03.2024\nAbtastzeit [us];2000\n\nZeit [ms];S-0-0051, Lageistwert Geber 1 [Grd];S-0-0053, \
         Lageistwert Geber 2 [Grd];S-0-0084, Drehmoment-/Kraft-Istwert [%]",
        |[t, u, y]| {
            format!(
                "{};{};{};{}",
                comma(1e3 * t),
                comma(40.0 * u),
                comma(40.0 * y),
                comma(y - u)
            )
        },
        &[
            "role = \"motor_position\"\nfile = \"oszilloskop.csv\"\ntime = \"Zeit [ms]\"\ntime_unit = \"ms\"\ncolumn = \"S-0-0051",
            "role = \"link_position\"\nfile = \"oszilloskop.csv\"\ntime = \"Zeit [ms]\"\ntime_unit = \"ms\"\ncolumn = \"S-0-0053",
        ],
    );
    // ODrive: of one axis with an accelerometer; two axes are two joints.
    is_read(
        "odrive.csv",
        "time,axis0.encoder.pos_estimate,axis0.controller.input_pos,link_position [rev]",
        |[t, u, y]| format!("{t:.3},{u:.6},{u:.6},{y:.6}"),
        &[
            "role = \"motor_position\"\n",
            "unit = \"rev\"  # guessed: ODrive",
            "role = \"command_position\"\n",
        ],
    );
    let head =
        "time,axis0.encoder.pos_estimate,axis0.encoder.vel_estimate,axis1.encoder.pos_estimate";
    let row = |[t, u, y]: [f64; 3]| format!("{t:.3},{u:.6},0.1,{y:.6}");
    let (_, manifest) = proposed(&exported("odrive.csv", head, row), "odrive.csv");
    has(
        &manifest,
        &["joint = \"0\"", "joint = \"1\"", "unit = \"rev/s\""],
    );
    // Startdrive: a number in brackets is an index, and no unit.
    let head = "Trace;Drive_1\nTime;r61[0] Actual speed value;r482[0] Encoder actual position value\nms;rpm;-";
    let row = |[t, u, _]: [f64; 3]| format!("{:.0};{u:.4};{:.0}", 1e3 * t, 4e5 * u);
    let (_, manifest) = proposed(&exported("trace.csv", head, row), "trace.csv");
    has(
        &manifest,
        &[
            "unit = \"rpm\"",
            "unit = \"raw\"  # guessed: no unit in its name",
        ],
    );
}

#[test]
fn lines_of_names_and_of_units_may_stand_in_a_block_above_the_numbers() {
    let rad = |[t, u, y]: [f64; 3]| format!(",{t:.3},{u:.6},{y:.6}");
    // TwinCAT Scope and dSPACE ControlDesk.
    is_read(
        "scope.csv",
        "TwinCAT Measurement Scope Export\nStartTime;133589520000000000\n\nName;Time;Axis 1.ActPos;Axis 1.LoadEnc\n\
         Unit;ms;°;°\nAms;;5.24.1.1.1.1;5.24.1.1.1.1\nPort;;851;851\n",
        |[t, u, y]| {
            format!(
                ";{};{};{}",
                comma(1e3 * t),
                comma(40.0 * u),
                comma(40.0 * y)
            )
        },
        &["time_unit = \"ms\"\ncolumn = \"3\"  # Axis 1.ActPos [°]\nunit = \"deg\""],
    );
    is_read(
        "desk.csv",
        "ControlDesk Export\n\"date\",\"2024-05-01\"\npath,,Model Root/theta_m/Out1,Model Root/theta_l/Out1\nunit,s,rad,rad\n\
         name,XAxis,theta_m,theta_l\ntrace_values,,,",
        rad,
        &["time = \"2\"\ncolumn = \"3\"", "unit = \"rad\""],
    );
}

#[test]
fn a_path_is_no_comment_and_its_unit_stands_in_the_last_brackets() {
    // TDMS, with the paths of its channels.
    let row = |k: i32| {
        let t = f64::from(k) / 2000.0;
        format!("{t:.4},{:.6}", tap(37.0, 0.015, t))
    };
    let head = "/'Measured Data'/'Time',/'Measured Data'/'cDAQ1Mod1/ai0 Accel X (g)'";
    let lines = std::iter::once(head.to_string()).chain((0..6000).map(row));
    let folder = written("tdms.csv", lines);
    let (_, manifest) = proposed(&folder, "tdms.csv");
    has(
        &manifest,
        &["time = \"/'Measured Data'/'Time'\"", "unit = \"g\""],
    );
    assert!(!manifest.contains("comment"), "{manifest}");
    is_near(mode(&folder), 37.0, 0.015);
    // Foxglove: rows of several topics, each with columns of its own, or with the same one.
    let row = |[t, u, y]: [f64; 3]| {
        let t = 1_714_554_842.3 + t;
        format!(
            "/motor/state,{t:.6},{u:.6},\n/imu/data,{:.6},,{:.6}",
            t + 3e-4,
            y - u
        )
    };
    let head = "topic,timestamp,motor_position,linear_acceleration.x";
    let folder = exported("run.csv", head, row);
    proposed(&folder, "run.csv");
    is_near(mode(&folder), MODE.0, MODE.1);
    let row = |[t, u, y]: [f64; 3]| format!("/motor,{t:.4},{u:.6}\n/link,{:.4},{y:.6}", t + 3e-4);
    let head = "topic,receive_time,position";
    let folder = exported("run.csv", head, row);
    let (told, manifest) = proposed(&folder, "run.csv");
    has(
        &told,
        &[
            "\"topic\" has /link, /motor",
            "only = { \"topic\" = \"/link\" }",
        ],
    );
    // What the rows have in common is not one signal.
    has(
        &manifest,
        &["only = { \"topic\" = \"/link\" }  # guessed: the first of several sensors"],
    );
}

#[test]
fn joint_states_without_a_header_are_known_by_their_names() {
    let row = |[t, u, y]: [f64; 3]| {
        let ns = (1e9 * t).round() as i64 + 300_000_000;
        let (s, ns) = (1_714_554_842 + ns / 1_000_000_000, ns % 1_000_000_000);
        format!("{s},{ns},,motor,link,{u:.6},{y:.6},0.5,0.25,0.0,0.0")
    };
    let folder = written("states.csv", joint().into_iter().map(row));
    let (_, manifest) = proposed(&folder, "states.csv");
    has(
        &manifest,
        &[
            "column = \"6\"  # motor position [rad]\nunit = \"rad\"",
            "column = \"7\"  # link position [rad]",
            "column = \"9\"  # link velocity [rad/s]\nunit = \"rad/s\"",
            "column = \"10\"  # motor effort [N.m]",
        ],
    );
    is_near(mode(&folder), MODE.0, MODE.1);
}

#[test]
fn what_is_no_table_of_numbers_is_told_with_what_to_do() {
    let said = |name: &str, lines: Vec<String>| {
        let folder = written(name, lines);
        quell(&folder, &["identify", name]).1
    };
    // LeRobot, as pandas writes it.
    let list = |[t, u, y]: [f64; 3]| format!("\"[{y:.5}, {u:.5}]\",{t:.3},0");
    let head = "observation.state,timestamp,index".to_string();
    let lines = std::iter::once(head).chain(joint().into_iter().map(list));
    let told = said("lerobot.csv", lines.collect());
    has(
        &told,
        &[
            "\"observation.state\" are lists",
            "\"observation.state[0]\"",
            "Parquet",
        ],
    );
    let echo =
        "header:\n  stamp:\n    sec: 1\n    nanosec: 0\n  frame_id: ''\nposition:\n- 0.5\n---";
    let told = said("echo.txt", vec![echo.replace('\n', "\r\n"); 20]);
    has(&told, &["ros2 topic echo --csv"]);
    // LinuxCNC's sampler counts its samples.
    let rows = joint().into_iter().enumerate();
    let lines = rows.map(|(k, [_, u, y])| format!("{k} {u:.6} {y:.6}"));
    let told = said("sampler.txt", lines.collect());
    has(
        &told,
        &["\"1\" goes by 1 from row to row", "write rate_hz ="],
    );
    assert!(!told.contains("1000"), "{told}");
}

#[test]
fn a_vibrometer_alone_tells_the_damping_of_the_mode() {
    let all = joint();
    let row = |k: usize| {
        let v = |k: usize| all[k][2] - all[k][1];
        format!(
            "{:.4},{:.6}",
            all[k][0],
            300.0 * (v(k + 1) - v(k - 1)) * RATE / 2.0
        )
    };
    let head = "Time [s],Vib velocity [mm/s]".to_string();
    let lines = std::iter::once(head).chain((1..all.len() - 1).map(row));
    let folder = written("vibrometer.csv", lines);
    proposed(&folder, "vibrometer.csv");
    let found = mode(&folder);
    is_near(found, MODE.0, MODE.1);
    assert!((found.1 / MODE.1 - 1.0).abs() < 0.01, "{found:?}");
}

/// Makers of robots have fixed what their signals are: poses and percentages are of no joint's sensor, and a joint torque sensor
/// does not tell what the motor gives.
#[test]
fn signals_of_robots_are_known_by_their_makers_names() {
    is_read(
        "franka.csv",
        "time,q_d[0],q[0],dq[0],tau_J[0],theta[0]",
        |[t, u, y]| format!("{t:.3},{u:.7},{y:.7},{u:.3},0.0,{u:.7}"),
        &[
            "role = \"link_position\"\njoint = \"0\"",
            "column = \"theta[0]\"\nunit = \"rad\"",
            "not used: tau_J[0]",
        ],
    );
    let kuka = exported(
        "kuka.csv",
        "time_s,$AXIS_ACT_MEAS.A1,$TORQUE_AXIS_ACT[1],$CURR_ACT[1],$POS_ACT.A,$POS_ACT_MES.X,AIPos.A1,ASPos.A1,MACur.A1",
        |[t, u, y]| format!("{t:.3},{y:.5},{u:.4},1.0,{u:.4},{y:.4},{y:.5},{u:.5},2.0"),
    );
    let (_, manifest) = proposed(&kuka, "kuka.csv");
    has(
        &manifest,
        &[
            "column = \"$AXIS_ACT_MEAS.A1\"\nunit = \"deg\"",
            "column = \"$TORQUE_AXIS_ACT[1]\"\nunit = \"N.m\"",
            "column = \"ASPos.A1\"\nunit = \"deg\"",
            "not used: $CURR_ACT[1], $POS_ACT.A, $POS_ACT_MES.X, ",
        ],
    );
    let servo = exported(
        "servo.csv",
        "Realtime Tick(ms),Present Position,Goal Position",
        |[t, u, y]| {
            format!(
                "{:.0},{:.0},{:.0}",
                1e3 * t,
                2048.0 + 600.0 * y,
                2048.0 + 600.0 * u
            )
        },
    );
    let (_, manifest) = proposed(&servo, "servo.csv");
    assert!(!manifest.contains("joint ="), "{manifest}");
    has(&manifest, &["role = \"command_position\"  # guessed"]);
}

/// A spreadsheet counts days: as seconds these were 2e7 samples a second, and a mode of 5e5 Hz.
#[test]
fn serial_dates_of_a_spreadsheet_are_days() {
    is_read(
        "log.csv",
        "datetime,motor_position_deg,link_position_deg",
        |[t, u, y]| format!("{:.12},{u:.6},{y:.6}", 45413.41666 + t / 86_400.0),
        &["time_unit = \"day\"  # guessed: serial dates of a spreadsheet"],
    );
}

/// What is in brackets is the unit of any quantity, and a controller's durations are stamps.
#[test]
fn a_row_of_units_and_durations_of_a_controller_are_read() {
    is_read(
        "scope.csv",
        "ActPos;SetTorque;State;Temperature;LinkPosition;Time\n[deg];[Nm];[];[\u{b0}C];[deg];[s]",
        |[t, u, y]| format!("{u:.6};0.0;1;31;{y:.6};{t:.3}").replace('.', ","),
        &[
            "unit = \"deg\"",
            "column = \"2\"  # SetTorque [Nm]\nunit = \"N.m\"",
            "time = \"6\"",
        ],
    );
    is_read(
        "plc.csv",
        "Time;MotorPosition [deg];LinkPosition [deg]",
        |[t, u, y]| {
            let ms = (1e3 * t).round() as u32;
            format!("T#{}s{}ms;{u:.6};{y:.6}", ms / 1000, ms % 1000)
        },
        &["time_unit = \"iec\""],
    );
}

/// What is left between command and measurement is no position.
#[test]
fn errors_of_control_are_no_positions_and_short_names_deflections() {
    is_read(
        "errors.csv",
        "time_s,jErr_deg,Lag [deg],following_error [deg],motor_position_deg,tip_defl_deg",
        |[t, u, y]| format!("{t:.3},{u:.6},{u:.6},{u:.6},{u:.6},{:.6}", y - u),
        &[
            "role = \"motor_position\"\nfile = \"errors.csv\"\ntime = \"time_s\"\ncolumn = \"motor_position_deg\"",
            "role = \"deformation\"\n",
            "not used: jErr_deg, Lag [deg], following_error [deg]",
        ],
    );
}

/// What no document of the maker tells is guessed, and marked as such.
#[test]
fn signals_of_robots_that_are_not_documented_are_guesses() {
    let kuka = exported(
        "kuka.csv",
        "time_s,$AXIS_ACT_MEAS.A1,ASPos.A1",
        |[t, u, y]| format!("{t:.3},{y:.5},{u:.5}"),
    );
    let (_, manifest) = proposed(&kuka, "kuka.csv");
    has(
        &manifest,
        &[
            "role = \"motor_position\"  # guessed: by the name",
            "role = \"command_position\"\n",
        ],
    );
}

//! Files as a careless engineer has them, as a user types it: each is refused in one line with its place, or read.

use assert_cmd::Command;
use std::path::Path;
use std::time::Duration;
use tempfile::TempDir;

const HEADER: &str = "time_s,motor_position_rad,deformation_rad";
const RATE: f64 = 250.0;
const MODEL: &str = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.2\ndamping_ratio = 0.06\n";
const MANIFEST: &str = "name = \"run\"
[[channel]]
role = \"motor_position\"
file = \"good.csv\"
time = \"time_s\"
column = \"motor_position_rad\"
unit = \"rad\"
[[channel]]
role = \"deformation\"
file = \"good.csv\"
time = \"time_s\"
column = \"deformation_rad\"
unit = \"rad\"
";

/// Rows of a move that only grows, and the decay after it at 8 Hz.
fn rows() -> Vec<String> {
    let w = 2.0 * std::f64::consts::PI * 8.0;
    let row = |k: i32| {
        let t = f64::from(k) / RATE;
        let s = ((t - 0.3) / 0.3).clamp(0.0, 1.0);
        let after = (t - 0.6).max(0.0);
        let rings = 5e-3 * (-0.05 * w * after).exp() * (w * after).sin();
        format!(
            "{t},{:.7},{:.7}",
            0.4 * s * s * (3.0 - 2.0 * s),
            rings + 1e-6 * f64::from(k % 7)
        )
    };
    (0..1000).map(row).collect()
}

/// The file of the rows after a change.
fn changed(change: impl Fn(&mut Vec<String>)) -> Vec<u8> {
    let mut rows = rows();
    change(&mut rows);
    format!("{HEADER}\n{}\n", rows.join("\n")).into()
}

/// What a verb says on stderr; it ends within a minute, without a panic.
fn told(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::cargo_bin("quell").unwrap();
    command.current_dir(folder).args(arguments);
    let output = command.timeout(Duration::from_secs(60)).output().unwrap();
    let words = String::from_utf8(output.stderr).unwrap();
    assert!(!words.contains("panicked"), "{arguments:?}: {words}");
    (output.status.code(), words)
}

/// Checks that a verb refuses what it is given in one line, beside a line of advice, which holds these words.
fn refused(folder: &Path, arguments: &[&str], words: &str) {
    let (code, said) = told(folder, arguments);
    assert_eq!(code, Some(2), "{arguments:?}: {said}");
    let advice = said
        .lines()
        .skip(1)
        .all(|line| line.starts_with("  help: "));
    assert!(said.lines().count() <= 2 && advice, "{arguments:?}: {said}");
    let first = said.lines().next().unwrap_or_default();
    assert!(first.contains(words), "{arguments:?}: {first}");
}

fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("good.csv", &changed(|_| {}));
    write("model.toml", MODEL.as_bytes());
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    folder
}

#[test]
fn a_file_that_cannot_be_used_is_refused_with_its_name_and_place() {
    let long = vec!["1"; 300_000].join(",");
    let utf_16: Vec<u8> = String::from_utf8(changed(|_| {}))
        .unwrap()
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let cut = [&[0xff, 0xfe], &utf_16[..2001]].concat();
    let cases: [(Vec<u8>, &str); 16] = [
        (Vec::new(), "run.csv: the file is empty"),
        (changed(Vec::clear), "run.csv: there are no rows"),
        (changed(|rows| rows.truncate(1)), "\"run\": "),
        (
            changed(|rows| rows.truncate(2)),
            "\"run\": 2 aligned samples",
        ),
        (
            changed(|rows| rows[500] = "2.0,0.4,0,7".into()),
            "run.csv:502: 4 cells",
        ),
        (
            changed(|rows| rows[500] = "2.0,0.4".into()),
            "run.csv:502: 2 cells",
        ),
        (
            changed(|rows| rows[500] = long.clone()),
            "run.csv:502: 300000 cells",
        ),
        (
            changed(|rows| rows[500] = "2.0,abc,0".into()),
            "whether \"abc\" in line 502 of \"motor_position_rad\"",
        ),
        (
            changed(|rows| rows[500] = "2.0,1e309,0".into()),
            "whether \"1e309\" in line 502",
        ),
        (
            changed(|rows| rows[500] = "2.0,1e308,1e308".into()),
            "\"run\": deformation holds 1e308 rad",
        ),
        // In the move, where each position stands once, as the number of a test may.
        (
            changed(|rows| rows[100] = rows[99].clone()),
            "run.csv: what its columns are is not certain: its time repeats: 0.396 stands twice",
        ),
        (
            changed(|rows| rows.swap(100, 101)),
            "its time runs backwards: 0.4 after 0.404",
        ),
        (
            changed(|rows| {
                rows.iter_mut()
                    .for_each(|row| *row = format!("1{}", &row[row.find(',').unwrap()..]))
            }),
            "its time repeats: 1 stands twice",
        ),
        (
            changed(|rows| {
                rows.iter_mut()
                    .for_each(|row| *row = format!("{},0.25", &row[..row.rfind(',').unwrap()]))
            }),
            "\"run\": deformation is 0.25 rad throughout",
        ),
        (cut, "run.csv: the text is not UTF-8"),
        ((0..=255).cycle().take(5000).collect(), "run.csv"),
    ];
    for (bytes, words) in &cases {
        let folder = folder();
        std::fs::write(folder.path().join("run.csv"), bytes).unwrap();
        refused(folder.path(), &["identify", "run.csv"], words);
        let (code, said) = told(folder.path(), &["score", "model.toml", "run.csv"]);
        assert_eq!(code, Some(2), "{words}: {said}");
        let (_, said) = told(folder.path(), &["inspect", "run.csv"]);
        // One repeated stamp is no reason to take a signal for the number of a test.
        let written = std::fs::read_dir(folder.path()).unwrap().count();
        assert!(written < 10, "{words}: {written} files, {said}");
    }
}

/// No command file gets a value that is no number: a train of such a value is infinite.
#[test]
fn a_command_that_nothing_can_follow_is_refused_and_nothing_is_written() {
    let folder = folder();
    let far = changed(|rows| rows[500] = "2.0,-1e308,0".into());
    std::fs::write(folder.path().join("run.csv"), far).unwrap();
    let shape = "shape --shaper zv --mode 8,0.05 --rate 250 run.csv --column motor_position_rad";
    let words = "run.csv:502: column \"motor_position_rad\": \"-1e308\" is beyond 1e27";
    refused(folder.path(), &shape.split(' ').collect::<Vec<_>>(), words);
    assert!(!folder.path().join("out/run_shaped.csv").exists());
}

#[test]
fn line_ends_a_byte_order_mark_and_missing_cells_are_read() {
    let text = String::from_utf8(changed(|_| {})).unwrap();
    let dos = text.replace('\n', "\r\n");
    let wide: Vec<u8> = dos.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let cases = [
        dos.clone().into_bytes(),
        [b"\xef\xbb\xbf", text.as_bytes()].concat(),
        [b"\xff\xfe", &wide[..]].concat(),
        changed(|rows| rows[500] = "2.0,nan,0".into()),
        changed(|rows| rows[500] = "2.0,,0".into()),
    ];
    for bytes in &cases {
        let folder = folder();
        std::fs::write(folder.path().join("run.csv"), bytes).unwrap();
        let (code, said) = told(folder.path(), &["identify", "run.csv"]);
        assert_eq!(code, Some(0), "{said}");
    }
}

#[test]
fn a_manifest_is_refused_with_line_and_key() {
    let cases = [
        (
            MANIFEST.replace("good.csv", "runs"),
            "run.toml:4: file: runs is a folder",
        ),
        (
            MANIFEST.replace("good.csv", "gone.csv"),
            "run.toml:4: file: there is no file gone.csv",
        ),
        (
            format!("{MANIFEST}{}", &MANIFEST[MANIFEST.find('[').unwrap()..]),
            "run.toml:15: role: \"motor_position\" stands twice",
        ),
        (
            MANIFEST.replace("\"deformation_rad\"", "3.5"),
            "run.toml:12: channel[2].column = 3.5",
        ),
        (
            format!("{MANIFEST}scale = 1e308\n"),
            "\"run\": deformation holds",
        ),
        (
            "name = \"run\"\n".into(),
            "run.toml: channel: there is none: write a block [[channel]]",
        ),
    ];
    for (manifest, words) in &cases {
        let folder = folder();
        std::fs::write(folder.path().join("run.toml"), manifest).unwrap();
        refused(folder.path(), &["identify", "run.toml"], words);
    }
}

/// Stamps in nanoseconds that are called seconds: 8.2 Hz would be 10^10 periods between two samples.
#[test]
fn a_score_of_a_recording_that_is_too_slow_for_the_model_is_refused_with_the_rate() {
    let folder = folder();
    let late = changed(|rows| {
        for (k, row) in rows.iter_mut().enumerate() {
            let comma = row.find(',').unwrap();
            *row = format!("{}{}", 1.7e18 + 4e6 * k as f64, &row[comma..]);
        }
    });
    std::fs::write(folder.path().join("run.csv"), late).unwrap();
    let words = "samples a second, and shows a mode of 8.2 Hz";
    refused(folder.path(), &["score", "model.toml", "run.csv"], words);
    let diagnose = ["diagnose", "--model", "model.toml", "run.csv"];
    refused(folder.path(), &diagnose, words);
}

/// The move of [`rows`] with the link's position in the place of the deformation, each changed; columns in rad.
fn link(change: impl Fn(f64, f64) -> [f64; 2]) -> Vec<u8> {
    let mut text = String::from("time_s,motor_position_rad,link_position_rad\n");
    for row in rows() {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [motor, link] = change(cells[1], cells[1] + cells[2]);
        text += &format!("{},{motor:.7},{link:.7}\n", cells[0]);
    }
    text.into()
}

/// A mistake of a sensor is told as that, by each verb, and never as a mode or as missing physics.
#[test]
fn a_sign_or_a_unit_that_is_wrong_is_told_as_that() {
    let folder = folder();
    let here = folder.path();
    let is_read = |bytes: Vec<u8>| {
        std::fs::write(here.join("run.csv"), bytes).unwrap();
        told(here, &["identify", "run.csv", "--out", "read"]).0
    };
    assert_eq!(is_read(link(|u, y| [u, y])), Some(0));
    assert_eq!(is_read(link(|u, y| [-u, -y])), Some(0));
    for (bytes, ratio, mistake) in [
        (link(|u, y| [u, -y]), "-1 times", "write scale = -1"),
        (
            link(|u, y| [u, y.to_degrees()]),
            "57.3 times",
            "link_position is in degrees",
        ),
        (
            link(|u, y| [u.to_degrees(), y]),
            "0.0175 times",
            "motor_position is in degrees",
        ),
        (
            link(|u, y| [80.0 * u, y]),
            "0.0125 times",
            "write scale = 0.0125 at the [[channel]] of motor_position",
        ),
    ] {
        std::fs::write(here.join("run.csv"), bytes).unwrap();
        for verb in [
            &["identify", "run.csv"][..],
            &["score", "model.toml", "run.csv"],
            &["diagnose", "--model", "model.toml", "run.csv"],
        ] {
            refused(
                here,
                verb,
                &format!("from rest to rest link_position moves {ratio} as far as motor_position"),
            );
            refused(here, verb, mistake);
        }
        let mut inspect = Command::cargo_bin("quell").unwrap();
        let output = inspect
            .current_dir(here)
            .args(["inspect", "run.csv", "--json"])
            .output()
            .unwrap();
        let words = String::from_utf8(output.stdout).unwrap();
        assert!(words.contains(ratio), "{words}");
        std::fs::remove_file(here.join("recording.toml")).unwrap();
    }
}

/// A gear, a unit or a sign that the manifest forgets is asked about where the motor side never rests, and is no physics.
#[test]
fn a_gear_is_told_in_motion_too() {
    let folder = folder();
    let here = folder.path();
    let w = 16.0 * std::f64::consts::PI;
    let tones =
        |t: f64| 0.5 * (2.2 * t).sin() + 0.2 * (5.0 * t + 1.0).sin() + 0.1 * (10.7 * t).sin();
    let rows = follows(tones, |off, rate, _| w * w * off + 0.06 * w * rate);
    let diagnose = [
        "diagnose",
        "--model",
        "model.toml",
        "run.csv",
        "--out",
        "out",
    ];
    for (scales, ratio) in [
        ([1.0, -1.0], "-1"),
        ([50.0, 1.0], "0.02"),
        ([-1.0, 50.0], "-50"),
    ] {
        let bytes = file(SIDES, &rows, |_, [u, y]| [scales[0] * u, scales[1] * y]);
        std::fs::write(here.join("run.csv"), bytes).unwrap();
        let words =
            format!("in slow motion link_position moves {ratio} times as far as motor_position");
        refused(here, &diagnose, &words);
        refused(here, &["identify", "run.csv"], &words);
    }
    // A scale that is wrong by half may be the sensor's: it is physics, and nothing is exchanged.
    let scaled = identified(here, &file(SIDES, &rows, |_, [u, y]| [1.5 * u, y]));
    assert!(!scaled.contains("exchanged"), "{scaled}");
}

/// Columns that are exchanged are told as that, by each verb: the shaper of such a fit would be for no mode of the machine.
#[test]
fn exchanged_columns_are_told_as_that() {
    let folder = folder();
    let here = folder.path();
    std::fs::write(here.join("run.csv"), link(|u, y| [y, u])).unwrap();
    for verb in [
        &["identify", "run.csv"][..],
        &["score", "model.toml", "run.csv"],
        &["diagnose", "--model", "model.toml", "run.csv"],
    ] {
        refused(here, verb, "motor_position follows link_position");
        refused(
            here,
            verb,
            "write role = \"link_position\" at the [[channel]] of motor_position",
        );
    }
}

/// A tip without a mode, whose sensor has an offset, an error of scale and noise, shows none.
#[test]
fn a_tip_that_only_follows_the_motor_side_has_no_mode() {
    let folder = folder();
    let here = folder.path();
    for (offset, scale) in [(0.0, 1.0), (0.01, 1.0), (0.0, 1.01), (0.002, 0.97)] {
        let state = std::cell::Cell::new(7_u64);
        // A sum of uniform numbers, near enough to a normal one.
        let noise = || {
            let uniform = || {
                let next = state
                    .get()
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1);
                state.set(next);
                (next >> 40) as f64 / f64::from(1 << 24) - 0.5
            };
            (0..12).map(|_| uniform()).sum::<f64>()
        };
        let bytes = link(|u, _| [u, offset + scale * u + 1e-4 * noise()]);
        std::fs::write(here.join("run.csv"), bytes).unwrap();
        refused(
            here,
            &["identify", "run.csv"],
            "no mode was found: the tip rests or follows the motor side",
        );
    }
}

/// A first stamp from before the clock was set: 54 years to the next one, which nothing simulates.
#[test]
fn a_stamp_of_another_clock_is_refused_with_the_one_before_it() {
    let folder = folder();
    let set = changed(|rows| {
        for (k, row) in rows.iter_mut().enumerate().skip(1) {
            let comma = row.find(',').unwrap();
            *row = format!("{}{}", 1.7e9 + 4e-3 * k as f64, &row[comma..]);
        }
    });
    std::fs::write(folder.path().join("run.csv"), set).unwrap();
    let manifest = MANIFEST.replace("good.csv", "run.csv");
    std::fs::write(folder.path().join("run.toml"), manifest).unwrap();
    let words = "1700000000.004 s follows 0 s";
    for arguments in [
        &["score", "model.toml", "run.toml"][..],
        &["diagnose", "--model", "model.toml", "run.toml"],
    ] {
        refused(folder.path(), arguments, words);
    }
    refused(
        folder.path(),
        &["identify", "run.toml"],
        "no mode was found",
    );
}

#[test]
fn each_kind_of_model_is_listed_once() {
    let folder = folder();
    std::fs::write(
        folder.path().join("kind.toml"),
        MODEL.replace("flexible_joint", "arm"),
    )
    .unwrap();
    let (_, said) = told(folder.path(), &["score", "kind.toml", "good.csv"]);
    assert!(
        said.contains("kind.toml:1: kind: \"arm\" is unknown; known: "),
        "{said}"
    );
    assert_eq!(said.matches("oscillator").count(), 1, "{said}");
}

/// Time, motor side and link at 500 Hz, with three moves and rests between them. The link goes by its law: its acceleration for
/// what it is behind the motor side, the rate of that, and its own rate.
fn driven(law: impl Fn(f64, f64, f64) -> f64) -> Vec<[f64; 3]> {
    let moves = [(0.5, 0.25, 0.5), (2.0, 0.25, -0.7), (3.5, 0.3, 0.9)];
    let motor = |t: f64| -> f64 {
        let gone = |(at, span, by): (f64, f64, f64)| {
            let s = ((t - at) / span).clamp(0.0, 1.0);
            by * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)
        };
        moves.into_iter().map(gone).sum()
    };
    follows(motor, law)
}

/// The same on any motion of the motor side, by small steps.
fn follows(motor: impl Fn(f64) -> f64, law: impl Fn(f64, f64, f64) -> f64) -> Vec<[f64; 3]> {
    let (steps, rate) = (40, 500.0);
    let (mut y, mut v, mut rows) = (motor(0.0), 0.0, Vec::new());
    for k in 0..2500 {
        let step = 1.0 / (rate * f64::from(steps));
        for j in 0..steps {
            let t = f64::from(k) / rate + f64::from(j) * step;
            let slope = (motor(t + step) - motor(t)) / step;
            v += step * law(motor(t) - y, slope - v, v);
            y += step * v;
        }
        rows.push([f64::from(k) / rate, motor(f64::from(k + 1) / rate), y]);
    }
    rows
}

/// A joint of 8 Hz, or another, with a damper across it.
fn joint(hertz: f64, damping_ratio: f64) -> Vec<[f64; 3]> {
    let w = 2.0 * std::f64::consts::PI * hertz;
    driven(|off, rate, _| w * w * off + 2.0 * damping_ratio * w * rate)
}

/// A file of such rows, each sensor through a change of its value at a time.
fn file(
    names: [&str; 2],
    rows: &[[f64; 3]],
    change: impl Fn(f64, [f64; 2]) -> [f64; 2],
) -> Vec<u8> {
    let mut text = format!("time_s,{},{}\n", names[0], names[1]);
    for [t, u, y] in rows {
        let [u, y] = change(*t, [*u, *y]);
        text += &format!("{t:.3},{u:.6},{y:.6}\n");
    }
    text.into()
}

/// Files that are not one table of numbers, or whose columns cannot be told, are refused with what to do.
#[test]
fn what_is_not_one_table_of_named_numbers_is_told_with_what_to_do() {
    let again = |header: &str| {
        let text = changed(|_| {});
        let text = String::from_utf8(text).unwrap();
        text.replacen(HEADER, header, 1).into_bytes()
    };
    let hexadecimal = |cell: usize| {
        changed(|rows| {
            for row in rows {
                let mut cells: Vec<String> = row.split(',').map(String::from).collect();
                let counts = (cells[cell].parse::<f64>().unwrap() * 1e5) as i32;
                cells[cell] = format!("0x{counts:08X}");
                *row = cells.join(",");
            }
        })
    };
    for (bytes, words) in [
        (
            changed(|rows| rows.insert(500, HEADER.into())),
            "line 502 repeats the header: the logger was started again there; make a file of each part",
        ),
        (
            hexadecimal(2),
            "\"0x00000000\" in line 2 of \"deformation_rad\" is hexadecimal: write the numbers as decimal ones",
        ),
        (
            again("time_s,deformation_rad,deformation_rad"),
            "which of the columns 2 and 3 is meant, both are called \"deformation_rad\"",
        ),
        (
            again("time_s,motor_position_rad,Armwinkel"),
            "which column shows what vibrates, of Armwinkel: add a [[channel]] block",
        ),
    ] {
        let folder = folder();
        std::fs::write(folder.path().join("run.csv"), bytes).unwrap();
        for verb in [
            &["identify", "run.csv"][..],
            &["diagnose", "--model", "model.toml", "run.csv"],
        ] {
            refused(folder.path(), verb, words);
        }
    }
    // A word of status beside the channels is no number that is meant, and two columns of the same numbers are one.
    for (header, cell) in [("status", Some("0x00A1")), ("time_s", None)] {
        let bytes = file(SIDES, &joint(8.0, 0.03), |_, x| x);
        let text = String::from_utf8(bytes).unwrap();
        let mut lines = text.lines();
        let first = format!("{},{header}\n", lines.next().unwrap());
        let last = |row: &str| match cell {
            Some(cell) => cell.to_owned(),
            None => row.split(',').next().unwrap().to_owned(),
        };
        let rows: String = lines.map(|row| format!("{row},{}\n", last(row))).collect();
        let folder = folder();
        is_of_8_hertz(&identified(folder.path(), (first + &rows).as_bytes()));
    }
}

const SIDES: [&str; 2] = ["motor_position_rad", "link_position_rad"];

/// What `quell identify` prints of a file, which it reads.
fn identified(folder: &Path, bytes: &[u8]) -> String {
    std::fs::write(folder.join("run.csv"), bytes).unwrap();
    let mut identify = Command::cargo_bin("quell").unwrap();
    let identify = identify.current_dir(folder);
    let arguments = ["identify", "run.csv", "--out", "read", "--force"];
    let output = identify.args(arguments).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    String::from_utf8(output.stdout).unwrap()
}

/// The recommended mode is the joint's, of 8 Hz.
fn is_of_8_hertz(text: &str) {
    let at = text.find("Recommended: ").unwrap();
    let hertz = text[at + 13..].split(' ').next().unwrap();
    let hertz: f64 = hertz.parse().unwrap();
    assert!((hertz - 8.0).abs() < 0.05, "{text}");
}

/// No shaper is of use for a lag of first order or an overdamped link, nor for the rounding of two encoders.
#[test]
fn what_does_not_ring_gets_no_shaper() {
    let folder = folder();
    let here = folder.path();
    let same = |_, x| x;
    let step = 2.0 * std::f64::consts::PI / 4096.0;
    let twelve_bits = |_, x: [f64; 2]| x.map(|angle| (angle / step).round() * step);
    // So fast a velocity loop about the lag that only its time constant is seen.
    let lag = driven(|off, _, rate| 1e4 * (off / 0.05 - rate));
    for (bytes, words) in [
        (
            file(SIDES, &lag, same),
            "a lag of first order, its time constant is 0.050 s",
        ),
        (
            file(SIDES, &joint(8.0, 1.2), same),
            "so that it is no resonance",
        ),
        (
            file(SIDES, &joint(120.0, 0.02), twelve_bits),
            "any mode is below what their steps show",
        ),
    ] {
        std::fs::write(here.join("run.csv"), bytes).unwrap();
        refused(here, &["identify", "run.csv"], "no mode was found");
        refused(here, &["identify", "run.csv"], words);
    }
    is_of_8_hertz(&identified(here, &file(SIDES, &joint(8.0, 0.03), same)));
    is_of_8_hertz(&identified(
        here,
        &file(SIDES, &joint(8.0, 0.03), twelve_bits),
    ));
}

/// A diagnosis says that nothing rings, and takes it neither for friction nor for a frequency that varies.
#[test]
fn a_diagnosis_of_what_does_not_ring_says_so() {
    let folder = folder();
    let here = folder.path();
    // Noise of both sensors, by irrational rotations.
    let noise = |t: f64, k: f64| 4e-5 * ((500.0 * t * k).fract() - 0.5);
    let noisy = |t: f64, [u, y]: [f64; 2]| [u + noise(t, 0.618), y + noise(t + 7.0, 0.414)];
    let step = 2.0 * std::f64::consts::PI / 4096.0;
    let twelve_bits = |_, x: [f64; 2]| x.map(|angle| (angle / step).round() * step);
    for (bytes, words) in [
        (
            file(SIDES, &joint(8.0, 1.2), noisy),
            "with a damping ratio near 1.20",
        ),
        (
            file(SIDES, &joint(120.0, 0.02), twelve_bits),
            "as if both were rigid",
        ),
    ] {
        std::fs::write(here.join("run.csv"), bytes).unwrap();
        let mut diagnose = Command::cargo_bin("quell").unwrap();
        let arguments = ["diagnose", "--model", "model.toml", "run.csv", "--force"];
        let output = diagnose.current_dir(here).args(arguments).output().unwrap();
        let said = String::from_utf8(output.stdout).unwrap();
        let first = said.lines().next().unwrap_or_default();
        assert!(
            first.starts_with("The recording shows no resonance to be modelled: "),
            "{said}"
        );
        assert!(first.contains(words), "{said}");
        assert!(!said.contains("end of what is believed"), "{said}");
        assert_eq!(output.status.code(), Some(2), "{said}");
    }
}

/// A sensor that hangs or is at its limit while the joint moves is told with the time, and the rest of the recording is used.
#[test]
fn a_sensor_that_hangs_is_left_out() {
    let folder = folder();
    let here = folder.path();
    let rows = joint(8.0, 0.03);
    let frozen = |k: usize| {
        move |t: f64, mut x: [f64; 2]| {
            if t >= 3.6 {
                x[k] = 0.04;
            }
            x
        }
    };
    let clipped = |_, [u, y]: [f64; 2]| [u, y.min(0.56)];
    for (bytes, words) in [
        (
            file(SIDES, &rows, frozen(0)),
            "motor_position hangs at one value, 0.04 rad, from 3.6 to 4.998 s",
        ),
        (
            file(SIDES, &rows, frozen(1)),
            "link_position hangs at one value, 0.04 rad, from 3.6 to 4.998 s",
        ),
        (
            file(SIDES, &rows, clipped),
            "link_position is at the end of its sensor's range, 0.56 rad, from 3.",
        ),
    ] {
        let text = identified(here, &bytes);
        assert!(text.contains(words), "{text}");
        is_of_8_hertz(&text);
        refused(
            here,
            &["diagnose", "--model", "model.toml", "run.csv"],
            words,
        );
        let mut inspect = Command::cargo_bin("quell").unwrap();
        let inspect = inspect.current_dir(here).args(["inspect", "run.csv"]);
        let told = String::from_utf8(inspect.output().unwrap().stdout).unwrap();
        assert!(told.contains(words), "{told}");
        std::fs::remove_file(here.join("recording.toml")).unwrap();
    }
}

/// An angle at the tip beside that of the motor is the link's where it goes as far; else it is asked for.
#[test]
fn a_tip_beside_a_motor_is_the_link() {
    let folder = folder();
    let here = folder.path();
    let rows = joint(8.0, 0.03);
    let degrees = |_, x: [f64; 2]| x.map(f64::to_degrees);
    is_of_8_hertz(&identified(
        here,
        &file(["motor_deg", "tip_deg"], &rows, degrees),
    ));
    is_of_8_hertz(&identified(here, &file(["Motor", "Tip"], &rows, degrees)));
    let bends = |_, [u, y]: [f64; 2]| [u, y - u].map(f64::to_degrees);
    std::fs::write(
        here.join("run.csv"),
        file(["motor_deg", "tip_deg"], &rows, bends),
    )
    .unwrap();
    refused(
        here,
        &["identify", "run.csv"],
        "whether \"tip_deg\" is a link_position",
    );
}

/// A separator of thousands is named as the cause, in each of its forms.
#[test]
fn separators_of_thousands_are_named() {
    let folder = folder();
    for (name, decimal, mark) in [
        ("us", ".", ","),
        ("swiss", ".", "'"),
        ("german", ",", "."),
        ("french", ",", " "),
    ] {
        let mut text = String::from("Time [ms];Motor (deg);Link [deg]\n");
        for [t, u, y] in joint(8.0, 0.03) {
            let ms = (1e3 * t).round();
            let (thousands, rest) = ((ms / 1e3).floor(), ms % 1e3);
            let time = match thousands > 0.0 {
                true => format!("{thousands}{mark}{rest:03}{decimal}0"),
                false => format!("{rest}{decimal}0"),
            };
            let cell = |value: f64| format!("{value:.6}").replace('.', decimal);
            text += &format!("{time};{};{}\n", cell(u), cell(y));
        }
        let file = format!("{name}.csv");
        std::fs::write(folder.path().join(&file), text).unwrap();
        let words = format!(
            "\"1{mark}000{decimal}0\" in line 502 of \"Time [ms]\" has a separator of thousands: write the numbers without it"
        );
        refused(folder.path(), &["identify", &file], &words);
    }
}

/// What the motor side did in a gap of the record is not known: the ringing after it is not for an impact.
#[test]
fn a_gap_in_a_move_is_no_impact() {
    let mut rows = joint(8.0, 0.05);
    rows.retain(|row| !(3.55..3.85).contains(&row[0]));
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let noise = |t: f64| 8e-5 * (((t * 1e4).sin() * 43758.545).fract().abs() - 0.5);
    write(
        "gap.csv",
        &file(SIDES, &rows, |t, [u, y]| [u, y + noise(t)]),
    );
    write("model.toml", MODEL.as_bytes());
    let mut diagnose = Command::cargo_bin("quell").unwrap();
    let diagnose = diagnose.current_dir(folder.path());
    let arguments = [
        "diagnose",
        "--model",
        "model.toml",
        "gap.csv",
        "--out",
        "out",
    ];
    let output = diagnose.args(arguments).output().unwrap();
    let told = String::from_utf8(output.stdout).unwrap();
    assert!(told.starts_with("Nothing is missing"), "{told}");
    assert!(
        told.contains("in 2 windows, each with a start of its own"),
        "{told}"
    );
}

/// Numbers that nothing is made for are refused with their option, before anything is planned or written.
#[test]
fn absurd_numbers_are_refused_with_option_and_value() {
    let folder = folder();
    let zvd = "shape --shaper zvd --mode 8,0.05 --rate";
    let asked = [
        (zvd, "--rate", &["1e308", "-1", "0", "NaN", "inf"][..]),
        (
            "shape --shaper zvd --rate 1000 --mode",
            "",
            &["1e-300,0.05"],
        ),
        (
            "shape --shaper zvd --rate 1000 --mode",
            "--mode",
            &["1e308,0.05", "-8,0.05", "8,NaN"],
        ),
        (
            "move --target",
            "--target",
            &["1e308", "-1e10", "NaN", "inf"],
        ),
        (
            "move --velocity",
            "--velocity",
            &["1e308", "1e-300", "0", "-5", "NaN"],
        ),
        (
            "move --acceleration",
            "--acceleration",
            &["1e308", "1e-300", "0", "-5"],
        ),
        ("move --jerk", "--jerk", &["1e308", "1e-300", "0", "-5"]),
        ("simulate --target", "--target", &["1e308", "NaN", "inf"]),
        ("simulate --dwell", "--dwell", &["-1", "NaN", "inf"]),
        (
            "prove --cases",
            "--cases",
            &["0", "-1", "1e308", "99999999999999999999"],
        ),
        #[cfg(feature = "serve")]
        (
            "serve --data data --rate",
            "rate",
            &["1e308", "-1", "0", "NaN", "249", "4001"],
        ),
    ];
    for (words, option, values) in asked {
        for value in values {
            let arguments: Vec<&str> = words.split(' ').chain([*value]).collect();
            let (code, said) = told(folder.path(), &arguments);
            assert_eq!(code, Some(2), "{arguments:?}: {said}");
            let first = said.lines().next().unwrap_or_default();
            let named = first.contains(option) && (option.is_empty() || first.contains(value));
            assert!(named && first.len() < 200, "{arguments:?}: {first}");
        }
    }
    for written in ["out", "data"] {
        assert!(!folder.path().join(written).exists(), "{written}");
    }
}

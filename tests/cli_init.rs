//! `quell init` asks what a file does not say of itself.

use assert_cmd::Command;
use std::f64::consts::TAU;
use std::fmt::Write;
use tempfile::TempDir;

/// A decay of 5.5 Hz and a damping ratio of .03 at 500 Hz, with noise: stamps in ms.
fn folder(header: &str, row: impl Fn(usize, f64) -> String) -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut text = header.to_owned();
    for k in 0..3_000_usize {
        let t = (k as f64 / 500.0 - 0.5).max(0.0);
        let w = TAU * 5.5;
        let rings = if t > 0.0 {
            (-0.03 * w * t).exp() * (w * t).sin()
        } else {
            0.0
        };
        let noise = (k * 7_919 % 1_000) as f64 / 1e3 - 0.5;
        writeln!(text, "{}", row(k, rings + 0.01 * noise)).unwrap();
    }
    std::fs::write(folder.path().join("data.csv"), text).unwrap();
    folder
}

/// Exit code, stdout, stderr.
fn quell(folder: &TempDir, arguments: &[&str], answers: &str) -> (Option<i32>, String, String) {
    let mut command = Command::cargo_bin("quell").unwrap();
    let output = command
        .current_dir(folder.path())
        .args(arguments)
        .write_stdin(answers)
        .output()
        .unwrap();
    let [out, error] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    (output.status.code(), out, error)
}

fn manifest(folder: &TempDir) -> String {
    std::fs::read_to_string(folder.path().join("recording.toml")).unwrap()
}

fn is_of_5_5_hertz(folder: &TempDir) {
    let (code, told, error) = quell(folder, &["identify", "recording.toml"], "");
    assert_eq!(code, Some(0), "{error}");
    assert!(
        told.contains("\n1      5.5")
            || told.contains("\n1     5.5")
            || told.contains("\n1     5.49"),
        "{told}"
    );
}

#[test]
fn a_column_is_asked_for_with_its_role_and_its_unit() {
    let folder = folder("time,signal\n", |k, y| format!("{},{y:.5}", 2 * k));
    // What cannot be is asked for again.
    let answers = "deflection\nlink_position\n\nkelvin\nmrad\n";
    let (code, told, asked) = quell(&folder, &["init", "data.csv"], answers);
    assert_eq!(code, Some(0), "{asked}");
    for words in [
        "role = \"deformation\", as by the name \"signal\"",
        "No role \"deflection\": one of ",
        "time_unit = \"ms\", as in seconds it were one sample in 2 s",
        "unit = \"raw\", as no unit in its name",
        "No unit \"kelvin\"",
    ] {
        assert!(asked.contains(words), "{words}: {asked}");
    }
    assert!(
        told.trim_end()
            .ends_with("Next: quell identify recording.toml"),
        "{told}"
    );
    let text = manifest(&folder);
    for line in [
        "role = \"link_position\"",
        "unit = \"mrad\"",
        "column = \"signal\"",
    ] {
        assert!(text.contains(&format!("\n{line}")), "{text}");
    }
    is_of_5_5_hertz(&folder);
    // A manifest that somebody has written is not replaced.
    std::fs::write(
        folder.path().join("recording.toml"),
        text.clone() + "# mine\n",
    )
    .unwrap();
    quell(&folder, &["init", "data.csv"], answers);
    assert!(manifest(&folder).ends_with("# mine\n"));
}

#[test]
fn a_guess_is_kept_without_an_answer_and_replaced_by_one() {
    let of = |k: usize, y: f64| format!("{},{y:.5},9.81,0.01", 2 * k);
    for (answers, words) in [
        ("", "role = \"tip_acceleration\"  # guessed"),
        ("\n\n\n", "role = \"tip_acceleration\"\n"),
        ("link_acceleration\n\n\n", "role = \"link_acceleration\"\n"),
    ] {
        let folder = folder("time,a,b,c\n", of);
        let (code, _, asked) = quell(&folder, &["init", "data.csv"], answers);
        assert_eq!(code, Some(0), "{asked}");
        assert!(manifest(&folder).contains(words), "{}", manifest(&folder));
    }
}

#[test]
fn a_rate_that_nobody_tells_is_an_error_and_nothing_is_written() {
    let header = "accel_x_g\n";
    let folder = folder(header, |_, y| format!("{y:.5}"));
    let (code, _, asked) = quell(&folder, &["init", "data.csv"], "");
    assert_eq!(code, Some(2), "{asked}");
    assert!(
        asked.contains("rate_hz: nothing in the file says it, and there was no answer"),
        "{asked}"
    );
    assert!(!folder.path().join("recording.toml").exists());
    let (code, told, asked) = quell(&folder, &["init", "data.csv"], "fast\n-3\n500\n");
    assert_eq!(code, Some(0), "{asked}");
    assert!(
        asked.contains("\"fast\" is no such number") && asked.contains("\"-3\" is no such number"),
        "{asked}"
    );
    assert!(told.contains("500.00"), "{told}");
    is_of_5_5_hertz(&folder);
    let (code, _, error) = quell(&folder, &["init", "recording.toml"], "");
    assert!(
        code == Some(2) && error.contains("no CSV or Parquet file"),
        "{error}"
    );
}

#[test]
fn a_block_is_filled_in_or_stays_a_comment() {
    let folder = folder("time_s,foo,bar\n", |k, y| {
        format!("{:.3},{y:.5},{}", k as f64 / 500.0, k % 3)
    });
    let (code, _, asked) = quell(&folder, &["init", "data.csv"], "deformation\nmm\n\n");
    assert_eq!(code, Some(0), "{asked}");
    for words in [
        "Role of column \"foo\" (empty: it is not used)",
        "Unit of deformation",
    ] {
        assert!(asked.contains(words), "{asked}");
    }
    let text = manifest(&folder);
    assert!(
        text.contains("\n[[channel]]\nrole = \"deformation\"\n"),
        "{text}"
    );
    assert!(text.contains("\n# column = \"bar\"\n"), "{text}");
    is_of_5_5_hertz(&folder);
}

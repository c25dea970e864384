//! Values that are read, and columns that are refused with their place.

use super::quell;
use super::written::Column::{Double, Float, Int32, Int64, Lists, Text, Unsigned};
use super::written::{Column, List, written};
use parquet::basic::{Compression, GzipLevel, ZstdLevel};
use quell::recording::{Recording, Table};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn all<T>(cells: impl IntoIterator<Item = T>) -> Vec<Option<T>> {
    cells.into_iter().map(Some).collect()
}

fn file(folder: &TempDir, columns: &[(&str, Column)]) -> PathBuf {
    let path = folder.path().join("run.parquet");
    std::fs::write(&path, written(columns, Compression::SNAPPY, 3)).unwrap();
    path
}

/// A manifest with a column of the file as a position.
fn manifest(folder: &Path, time: &str, column: &str) -> PathBuf {
    let path = folder.join("recording.toml");
    let text = format!(
        "name = \"x\"\n[[channel]]\nrole = \"motor_position\"\nfile = \"run.parquet\"\n{time}\ncolumn = \"{column}\"\nunit = \"rad\"\n"
    );
    std::fs::write(&path, text).unwrap();
    path
}

fn refused(folder: &TempDir, time: &str, column: &str) -> String {
    let path = manifest(folder.path(), time, column);
    Recording::from_path(path).unwrap_err().to_string()
}

#[test]
fn numbers_are_read_to_the_bit() {
    let folder = TempDir::new().unwrap();
    let big = 1_763_000_000_123_456_789_i64;
    let halves: Vec<List> = vec![
        Some(all([0.1, f32::MIN_POSITIVE])),
        None,
        Some(vec![None, Some(-2.5)]),
        Some(all([1.0, 2.0])),
    ];
    let columns = [
        (
            "double",
            Double(all([1e300, -5e-324, std::f64::consts::PI, 0.0])),
        ),
        ("float", Float(all([0.1, -1e-38, 3.4e38, 0.0]))),
        ("int", Int32(all([i32::MIN, -1, 0, i32::MAX]))),
        ("long", Int64(all([big, big + 1, big + 2, i64::MIN]))),
        ("unsigned", Unsigned(all([-1, 0, 1, 2]))),
        ("nulls", Double(vec![None, Some(1.5), None, None])),
        ("state", Lists(halves)),
    ];
    let codecs = [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::GZIP(GzipLevel::default()),
        Compression::ZSTD(ZstdLevel::default()),
    ];
    for (codec, rows) in codecs.into_iter().zip([4, 1, 2, 3]) {
        let path = folder.path().join("run.pq");
        std::fs::write(&path, written(&columns, codec, rows)).unwrap();
        let table = Table::open(&path).unwrap();
        assert_eq!(table.header()[6..], ["state[0]", "state[1]"]);
        let read = |name: &str| table.numbers(&[name]).unwrap().swap_remove(0);
        assert_eq!(read("double"), [1e300, -5e-324, std::f64::consts::PI, 0.0]);
        assert_eq!(read("float"), [0.1_f32, -1e-38, 3.4e38, 0.0].map(f64::from));
        assert_eq!(read("int"), [i32::MIN, -1, 0, i32::MAX].map(f64::from));
        assert_eq!(read("unsigned"), [u64::MAX as f64, 0.0, 1.0, 2.0]);
        let nulls = |name: &str| {
            read(name)
                .iter()
                .map(|value| value.is_nan())
                .collect::<Vec<_>>()
        };
        assert_eq!(nulls("nulls"), [true, false, true, true]);
        assert_eq!(nulls("state[0]"), [false, true, true, false]);
        assert_eq!(read("state[0]")[0], f64::from(0.1_f32));
        assert_eq!(read("state[1]")[2..], [-2.5, 2.0]);
        // Nanoseconds since an epoch need more digits than an f64 has.
        let cells: Vec<_> = table
            .rows()
            .map(|row| row.unwrap()[3].to_string())
            .collect();
        assert_eq!(cells[1], "1763000000123456790");
    }
}

/// A row with a null is left out, with a column of stamps as with a rate.
#[test]
fn nulls_are_missing_samples() {
    let folder = TempDir::new().unwrap();
    let columns = [
        ("t", Float(vec![Some(0.0), Some(0.5), None, Some(1.5)])),
        ("q", Double(vec![None, Some(2.0), Some(3.0), Some(4.0)])),
        // A column that no channel names may hold anything.
        ("task", Text(all(["a", "b", "c", "d"]))),
    ];
    file(&folder, &columns);
    for (time, stamps) in [
        ("time = \"t\"", &[0.5, 1.5][..]),
        ("rate_hz = 2", &[0.5, 1.0, 1.5]),
    ] {
        let read = Recording::from_path(manifest(folder.path(), time, "q")).unwrap();
        assert_eq!(read.channels[0].time, stamps);
        assert_eq!(read.channels[0].columns[0][0], 2.0);
    }
}

#[test]
fn a_column_is_refused_with_its_place() {
    let folder = TempDir::new().unwrap();
    let uneven: Vec<List> = [2, 2, 2, 1]
        .map(|length| Some(all(vec![1.0; length])))
        .into();
    let columns = [
        ("t", Double(all([0.0, 1.0, 2.0, 2.0]))),
        ("q", Double(all([0.0, 1.0, 2.0, 3.0]))),
        ("nan", Float(all([0.0, 1.0, f32::NAN, 3.0]))),
        ("task", Text(all(["a", "b", "c", "d"]))),
        ("boxes", Lists(uneven)),
        ("state", Lists(vec![Some(all([1.0, 2.0])); 4])),
    ];
    let path = file(&folder, &columns);
    let path = path.display();
    for (column, words) in [
        ("nan", " row 2: column \"nan\": "),
        (
            "task",
            " column \"task\": it holds texts or bytes (BYTE_ARRAY), not numbers of 32 or 64 bits",
        ),
        (
            "boxes[1]",
            " row 3: column \"boxes\": the list has 1 elements, but those before have 2",
        ),
        ("state[2]", " column \"state[2]\": no such column; "),
        (
            "state",
            " column \"state\": no such column; the columns are: t, q, nan, state[0], state[1]",
        ),
        ("joint", " column \"joint\": no such column; "),
    ] {
        let told = refused(&folder, "rate_hz = 10", column);
        assert!(
            told.starts_with(&format!("{path}:")) && told.contains(words),
            "{told}"
        );
    }
    let told = refused(&folder, "time = \"t\"", "q");
    assert!(
        told.contains("run.parquet: row 3: column \"t\": "),
        "{told}"
    );
    // The whole file is read without the columns that are not numbers.
    let table = Table::open(&folder.path().join("run.parquet")).unwrap();
    assert_eq!(table.header(), ["t", "q", "nan", "state[0]", "state[1]"]);
}

/// A decay as pandas writes it: no manifest is needed, and a mode is found.
#[test]
fn a_file_that_means_one_thing_is_identified() {
    let folder = TempDir::new().unwrap();
    let (hertz, ratio, rate) = (7.3, 0.02, 400.0);
    let times: Vec<f64> = (0..1600).map(|k| f64::from(k) / rate).collect();
    let swing = |t: &f64| 3.0 * (-ratio * TAU * hertz * t).exp() * (TAU * hertz * t).sin();
    // The estimators need some noise.
    let noise = |k: usize| 1e-3 * ((k * 7919) as f64 * 12.9898).sin();
    let accel = times.iter().enumerate().map(|(k, t)| swing(t) + noise(k));
    let columns = [
        ("time_s", Double(all(times.clone()))),
        ("accel_m_s2", Double(all(accel))),
    ];
    file(&folder, &columns);
    let (code, out, err) = quell(folder.path(), &["identify", "run.parquet", "--json"]);
    assert_eq!(code, Some(0), "{err}");
    let found: serde_json::Value = serde_json::from_str(&out).unwrap();
    let found = found["recordings"][0]["modes"][0]["frequency_hz"]
        .as_f64()
        .unwrap();
    assert!((found / hertz - 1.0).abs() < 1e-3, "{found}");
}

//! Damaged files are refused with their place, and nothing panics.

use super::quell;
use super::written::Column::{Double, Float, Int32, Int64, Lists};
use super::written::written;
use parquet::basic::{Compression, ZstdLevel};
use quell::recording::Table;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use tempfile::TempDir;

fn sound(codec: Compression) -> Vec<u8> {
    let count = 0..40;
    let columns = [
        (
            "t",
            Double(count.clone().map(|k| Some(f64::from(k) * 0.1)).collect()),
        ),
        (
            "q",
            Float(
                count
                    .clone()
                    .map(|k| (k % 7 != 3).then_some(k as f32))
                    .collect(),
            ),
        ),
        ("n", Int32(count.clone().map(|k| Some(k / 20)).collect())),
        (
            "m",
            Int64(count.clone().map(|k| Some(i64::from(k) << 40)).collect()),
        ),
        (
            "state",
            Lists(
                count
                    .map(|k| Some(vec![Some(k as f32), None, Some(1.0)]))
                    .collect(),
            ),
        ),
    ];
    written(&columns, codec, 25)
}

/// Result of reading a file and all its columns.
fn told(folder: &TempDir, bytes: &[u8]) -> Result<(), String> {
    let path = folder.path().join("run.parquet");
    // A new file: some file systems flush one that is overwritten to the disk.
    let _ = std::fs::remove_file(&path);
    std::fs::write(&path, bytes).unwrap();
    let table = Table::open(&path).map_err(|error| error.to_string())?;
    for name in table.header() {
        // A changed value may be NaN, which is an error of its own.
        let _ = table.numbers(&[name]);
    }
    Ok(())
}

#[test]
fn a_file_that_is_cut_off_is_refused_with_the_byte() {
    let folder = TempDir::new().unwrap();
    let whole = sound(Compression::SNAPPY);
    assert_eq!(told(&folder, &whole), Ok(()));
    assert!(
        told(&folder, &[])
            .unwrap_err()
            .contains("run.parquet: the file is empty")
    );
    for length in 1..whole.len() {
        let words = told(&folder, &whole[..length]).unwrap_err();
        let place = format!(
            "run.parquet: byte {length}: the Parquet data cannot be read: it ends without PAR1"
        );
        assert!(words.contains(&place), "{length}: {words}");
    }
    // Also a file that lacks its middle.
    let words = told(
        &folder,
        &[&whole[..20], &whole[whole.len() - 60..]].concat(),
    )
    .unwrap_err();
    assert!(words.contains("run.parquet"), "{words}");
    let (code, _, err) = quell(folder.path(), &["inspect", "run.parquet"]);
    assert_eq!(code, Some(2));
    assert!(err.contains("the Parquet data cannot be read"), "{err}");
}

/// A wrong byte gives a wrong number, or an error that names the file.
#[test]
fn wrong_bytes_never_panic() {
    let folder = TempDir::new().unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut refused = 0;
    let codecs = [
        Compression::UNCOMPRESSED,
        Compression::SNAPPY,
        Compression::ZSTD(ZstdLevel::default()),
    ];
    for codec in codecs {
        let whole = sound(codec);
        let mut changed = whole.clone();
        for place in 0..whole.len() {
            for _ in 0..3 {
                changed[place] = random.random();
                if let Err(words) = told(&folder, &changed) {
                    assert!(words.contains("run.parquet"), "{words}");
                    refused += 1;
                }
            }
            changed[place] = whole[place];
        }
        for _ in 0..2000 {
            for _ in 0..random.random_range(2..8) {
                let place = random.random_range(0..whole.len());
                changed[place] = random.random();
            }
            let _ = told(&folder, &changed);
            changed.clone_from(&whole);
        }
    }
    assert!(refused > 1000, "{refused}");
}

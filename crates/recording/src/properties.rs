//! Properties that hold for every input of the reader.

use super::MANIFEST;
use super::error::from_io;
use super::health::{health, remarks};
use super::manifest::read;
use super::{Channel, RecordingError, Role};
use proptest::prelude::*;

const VALID: &str = "name = \"x\"\n[[channel]]\nrole = \"motor_position\"\nfile = \"a.csv\"\n\
                     time = \"t\"\ncolumn = \"q\"\nunit = \"deg\"\n";

/// Reads a folder with these two files and, if that succeeds, computes its health.
fn read_any(manifest: &[u8], csv: &[u8]) -> Result<(), RecordingError> {
    let folder = tempfile::TempDir::new().map_err(|error| from_io(&error).in_file("".as_ref()))?;
    for (name, bytes) in [(MANIFEST, manifest), ("a.csv", csv)] {
        std::fs::write(folder.path().join(name), bytes)
            .map_err(|error| from_io(&error).in_file("".as_ref()))?;
    }
    for channel in &mut read(folder.path(), None)?.channels {
        remarks(channel, &health(channel));
        channel.unwrap_turns();
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn no_csv_makes_it_panic(
        bytes in proptest::collection::vec(any::<u8>(), 0..200),
        text in "t[,;]q\n([-0-9.e,;\"\r\n nai]{0,8}\n){0,20}",
        cells in proptest::collection::vec(any::<f64>(), 0..40),
        packed: bool,
    ) {
        let mut table = String::from("t,q\n");
        for (row, value) in cells.iter().filter(|value| value.is_finite()).enumerate() {
            table.push_str(&format!("{row},{value:e}\n"));
        }
        for mut csv in [bytes, text.into_bytes(), table.into_bytes()] {
            if packed {
                csv.splice(0..0, [0x1f, 0x8b, 8]);
            }
            let _ = read_any(VALID.as_bytes(), &csv);
        }
    }

    #[test]
    fn no_manifest_makes_it_panic(
        bytes in proptest::collection::vec(any::<u8>(), 0..200),
        place in 0..VALID.len(),
        insert in "[-\\[\\]=\"'#.a-z0-9\u{e4}\n ]{0,12}",
    ) {
        let mut text = VALID.to_owned();
        text.insert_str(place, &insert);
        for manifest in [bytes, text.into_bytes()] {
            let _ = read_any(&manifest, b"t,q\n0,1\n1,2\n");
        }
    }

    #[test]
    fn unwrapping_undoes_wrapping(start in -9.0..9.0, steps in proptest::collection::vec(
        -0.1..0.3, 30..99)
    ) {
        let straight: Vec<f64> = steps.iter().scan(start, |angle, step| {
            *angle += step;
            Some(*angle)
        }).collect();
        let tau = std::f64::consts::TAU;
        let wrapped = straight.iter().map(|angle| angle.rem_euclid(tau)).collect();
        let time = (0..straight.len()).map(|sample| sample as f64).collect();
        let (role, unit) = (Role::MotorPosition, "rad".into());
        let mut channel = Channel { role, unit, time, columns: vec![wrapped] };
        channel.unwrap_turns();
        let offset = channel.columns[0][0] - straight[0];
        for (unwrapped, angle) in channel.columns[0].iter().zip(&straight) {
            // Sums of up to ten numbers below 40.
            prop_assert!((unwrapped - angle - offset).abs() < 1e-12);
        }
    }
}

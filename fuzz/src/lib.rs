//! The common parts of the targets: a folder in memory, and what holds of every recording that was read.

use quell::recording::health::{health, remarks};
use quell::recording::{Channel, Recording, Role, Table};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder of files that one input after the other overwrites.
pub struct Folder(TempDir);

impl Default for Folder {
    fn default() -> Self {
        let memory = Path::new("/dev/shm");
        let made = match memory.is_dir() {
            true => TempDir::new_in(memory),
            false => TempDir::new(),
        };
        Self(made.expect("a folder for the inputs"))
    }
}

impl Folder {
    /// Writes a file and gives its path.
    pub fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).expect("room for an input");
        path
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        self.0.path()
    }
}

/// Whether the values are finite, stamps strictly increase and columns are as long as they; what is told of
/// the channel's health must not panic either.
pub fn check_channel(channel: &Channel) {
    let samples = channel.time.len();
    assert!(samples > 0 && channel.time.windows(2).all(|pair| pair[0] < pair[1]));
    let mut columns = channel.columns.iter();
    assert!(columns.all(|column| column.len() == samples));
    let mut values = channel.time.iter().chain(channel.columns.iter().flatten());
    assert!(values.all(|value| value.is_finite()));
    remarks(channel, &health(channel));
}

/// Checks all channels; what is written must be read back to the bit, and what is unwrapped be as long.
pub fn check_recording(mut recording: Recording, folder: &Folder) {
    recording.channels.iter().for_each(check_channel);
    let copy = folder.path().join("copy");
    recording
        .write(&copy, false)
        .expect("what was read can be written");
    assert_eq!(Recording::from_path(&copy).as_ref(), Ok(&recording));
    recording
        .channels
        .iter_mut()
        .for_each(Channel::unwrap_turns);
}

/// Checks a table: rows are as wide as the header, and where the first column is stamps and the second numbers, the recording
/// of both.
pub fn check_table(table: &Table, folder: &Folder) {
    let width = table.header().len();
    for row in table.rows().flatten() {
        assert_eq!(row.len(), width);
    }
    let [first, second, ..] = table.header() else {
        return;
    };
    for rate_hz in [250.0, 1.0] {
        let _ = table
            .stamps_at_rate(first, rate_hz)
            .map_err(|error| error.to_string());
    }
    let (time, columns) = match (table.stamps(first), table.numbers(&[second])) {
        (Ok(time), Ok(columns)) => (time, columns),
        (time, columns) => {
            let told = [time.err(), columns.err()].into_iter().flatten();
            return told.for_each(|error| assert!(!error.to_string().is_empty()));
        }
    };
    let (role, unit) = (Role::MotorPosition, "rad".into());
    let channels = vec![Channel {
        role,
        unit,
        time,
        columns,
    }];
    check_recording(
        Recording {
            name: String::new(),
            payload: None,
            channels,
        },
        folder,
    );
}

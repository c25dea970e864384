//! The journal of a recording, on disk as it comes: a service that is killed leaves it readable up to the cut.

use std::path::Path;

use super::log::{Log, Written};
use crate::recording::{McapWriter, RecordingError};
use crate::service::disk::{Disk, beside};

/// A file that grows with its recording. It is replaced once the recording is whole.
pub struct Journal {
    file: McapWriter,
    written: Written,
}

impl Journal {
    /// Begins a file with what has come so far. It takes its name then, so that one of before a failure
    /// is there until this one has as much.
    pub fn begin(
        disk: &Disk,
        path: &Path,
        log: &Log,
        joint: &str,
        epoch: f64,
    ) -> Result<Self, RecordingError> {
        let path_of_new = beside(path);
        let refused = |error| RecordingError::io(&path_of_new, &error);
        let file = disk.storage().create(&path_of_new).map_err(refused)?;
        let mut journal = Self {
            file: log.begin_mcap(file, path, joint, epoch)?,
            written: log.nothing_written(),
        };
        journal.write(log, joint)?;
        // What takes a name is on the medium; what comes later is there when the system writes it.
        let storage = disk.storage();
        let renamed = storage
            .sync(&path_of_new)
            .and_then(|()| storage.rename(&path_of_new, path));
        renamed.map_err(refused)?;
        Ok(journal)
    }

    /// Writes what has come since the last time.
    pub fn write(&mut self, log: &Log, joint: &str) -> Result<(), RecordingError> {
        log.write_on(&mut self.written, &mut self.file, joint)?;
        self.file.flush()
    }
}

//! The journal of a recording, written during the recording: after a kill it is readable up to the cut.

use std::fs;
use std::path::{Path, PathBuf};

use super::log::{Log, Written};
use crate::recording::{McapWriter, RecordingError};
use crate::service::disk::{Disk, beside};

/// A file that grows with its recording. It is replaced once the recording is complete.
pub struct Journal {
    path: PathBuf,
    file: McapWriter,
    written: Written,
}

impl Journal {
    /// Begins a file with the samples so far. It gets its name only then, so that a file from before a failure
    /// stays until this one contains as much.
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
            path: path.into(),
            file: log.begin_mcap(file, path, joint, epoch)?,
            written: log.nothing_written(),
        };
        journal.write(log, joint)?;
        // A renamed file is durable; later data are there when the system writes them.
        let storage = disk.storage();
        let renamed = storage
            .sync(&path_of_new)
            .and_then(|()| storage.rename(&path_of_new, path));
        renamed.map_err(refused)?;
        Ok(journal)
    }

    /// Writes the samples since the last call.
    pub fn write_more(&mut self, log: &Log, joint: &str) -> Result<(), RecordingError> {
        // A file that is open takes more although nobody can find it any more.
        fs::metadata(&self.path).map_err(|error| RecordingError::io(&self.path, &error))?;
        self.write(log, joint)
    }

    fn write(&mut self, log: &Log, joint: &str) -> Result<(), RecordingError> {
        log.write_on(&mut self.written, &mut self.file, joint)?;
        self.file.flush()
    }
}

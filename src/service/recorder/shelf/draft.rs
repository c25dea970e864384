//! The folder of a recording before it is on the shelf.

use std::fs;
use std::path::{Path, PathBuf};

use super::MCAP;
use crate::recording::{Recording, RecordingError, Sink};
use crate::service::disk::{Disk, beside};

/// A folder to be filled. The complete file is written beside the one that has grown with the recording, which
/// stays until everything is on the disk.
pub struct Draft<'a> {
    pub(super) folder: &'a Path,
    pub(super) disk: &'a Disk,
}

impl Draft<'_> {
    /// The complete file: its path, for errors, and its writer.
    ///
    /// # Errors
    /// [`RecordingError`] where the disk refuses.
    pub fn mcap(&self) -> Result<(PathBuf, Sink), RecordingError> {
        let path = beside(&self.folder.join(MCAP));
        let file = self.disk.storage().create(&path);
        let file = file.map_err(|error| RecordingError::io(&path, &error))?;
        Ok((path, file))
    }

    /// Manifest and CSV files.
    ///
    /// # Errors
    /// [`RecordingError`] where it could not be read back, or the disk refuses.
    pub fn recording(&self, recording: &Recording) -> Result<(), RecordingError> {
        let storage = self.disk.storage();
        recording.write_by(self.folder, true, |path| storage.create(path))
    }

    /// A file of these bytes.
    ///
    /// # Errors
    /// [`RecordingError`] where the disk refuses.
    pub fn bytes(&self, name: &str, bytes: &[u8]) -> Result<(), RecordingError> {
        let path = beside(&self.folder.join(name));
        let written = self.disk.storage().create(&path).and_then(|mut file| {
            file.write_all(bytes)?;
            file.flush()
        });
        written.map_err(|error| RecordingError::io(&path, &error))
    }

    /// A copy of a file.
    ///
    /// # Errors
    /// [`RecordingError`] where it cannot be read, or the disk refuses.
    pub fn copy(&self, file: &Path, name: &str) -> Result<(), RecordingError> {
        let bytes = fs::read(file).map_err(|error| RecordingError::io(file, &error))?;
        self.bytes(name, &bytes)
    }
}

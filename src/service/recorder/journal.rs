//! What is being recorded, on disk as it comes: a service that is killed leaves it readable up to the cut.

use std::path::Path;
use std::sync::Arc;

use super::log::{Log, Written};
use super::running::Running;
use super::task::Task;
use super::{MCAP, Shelf, ShelfError};
use crate::recording::{McapWriter, RecordingError};
use crate::service::contract::{DiskPart, RecordingNews};
use crate::service::disk::{Disk, beside};

/// How often what has come is written down, s: what a kill may cost. As often as the file closes its
/// chunks by itself.
const EVERY: f64 = 0.25;

/// A file that grows with its recording. It is replaced once the recording is whole.
pub struct Journal {
    file: McapWriter,
    written: Written,
}

impl Journal {
    /// Begins a file with what has come so far. It takes its name then, so that one of before a failure
    /// is there until this one has as much.
    fn begin(
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

    fn write(&mut self, log: &Log, joint: &str) -> Result<(), RecordingError> {
        log.write_on(&mut self.written, &mut self.file, joint)?;
        self.file.flush()
    }
}

impl Running {
    /// Writes down what has come since the last time. Where the disk refuses, the recording is begun
    /// anew on it when there is room again, and is still kept at its end.
    fn write_down(&mut self, shelf: &Shelf, epoch: f64) {
        let no_room = self.journal.is_none() && shelf.disk().is_failing(DiskPart::Recordings);
        if self.unwritable || no_room || !self.log.is_measured() {
            return;
        }
        let written = self.try_to_write_down(shelf, epoch);
        if let Err(error) = shelf.told(written) {
            (self.journal, self.described) = (None, false);
            self.unwritable = !error.is_disk();
            if self.unwritable {
                tracing::warn!(name = self.name, %error, "is not written down while it is made");
            }
        }
    }

    fn try_to_write_down(&mut self, shelf: &Shelf, epoch: f64) -> Result<(), ShelfError> {
        if !self.described {
            shelf.begin(&self.name, &self.about)?;
            self.described = true;
        }
        let joint = &self.about.joint;
        match &mut self.journal {
            Some(journal) => journal.write(&self.log, joint)?,
            None => {
                let path = shelf.unfinished(&self.name).join(MCAP);
                let journal = Journal::begin(shelf.disk(), &path, &self.log, joint, epoch)?;
                self.journal = Some(journal);
            }
        }
        Ok(())
    }
}

impl Task {
    /// Has written down what has come, now and then, on a thread that may wait for the disk.
    pub(super) async fn write_down(&mut self, now: f64) {
        if self.running.is_empty() || now - self.written < EVERY {
            return;
        }
        self.written = now;
        let epoch = self.epoch();
        let (shelf, mut running) = (Arc::clone(&self.shelf), std::mem::take(&mut self.running));
        let names: Vec<_> = running.iter().map(|one| one.name.clone()).collect();
        let work = tokio::task::spawn_blocking(move || {
            let all = running.iter_mut();
            all.for_each(|one| one.write_down(&shelf, epoch));
            running
        });
        match work.await {
            Ok(running) => self.running = running,
            Err(error) => {
                tracing::error!(%error, "what was being recorded is lost");
                for name in names {
                    self.shelf.disk().lost_recording();
                    self.handle.tell(RecordingNews::Gone { name });
                }
            }
        }
        let handle = &self.handle;
        self.running.iter_mut().for_each(|one| one.tell(handle));
    }
}

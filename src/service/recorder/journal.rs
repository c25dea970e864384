//! What is being recorded, on disk as it comes: a service that is killed leaves it readable up to the cut.

use std::path::Path;
use std::sync::Arc;

use super::log::{Log, Written};
use super::{MCAP, Running, Shelf, ShelfError, Task};
use crate::recording::{McapWriter, RecordingError};

/// How often what has come is written down, s: what a kill may cost. As often as the file closes its
/// chunks by itself.
const EVERY: f64 = 0.25;

/// A file that grows with its recording. It is replaced once the recording is whole.
pub struct Journal {
    file: McapWriter,
    written: Written,
}

impl Journal {
    fn begin(folder: &Path, log: &Log, joint: &str, epoch: f64) -> Result<Self, RecordingError> {
        Ok(Self {
            file: log.begin_mcap(&folder.join(MCAP), joint, epoch)?,
            written: log.nothing_written(),
        })
    }

    fn write(&mut self, log: &Log, joint: &str) -> Result<(), RecordingError> {
        log.write_on(&mut self.written, &mut self.file, joint)?;
        self.file.flush()
    }
}

impl Running {
    /// Writes down what has come since the last time. Where the disk refuses, the recording is still
    /// kept at its end.
    fn write_down(&mut self, shelf: &Shelf, epoch: f64) {
        if self.unwritten || !self.log.is_measured() {
            return;
        }
        if let Err(error) = self.try_to_write_down(shelf, epoch) {
            tracing::warn!(%error, "a recording is not written down while it is made");
            (self.unwritten, self.journal) = (true, None);
        }
    }

    fn try_to_write_down(&mut self, shelf: &Shelf, epoch: f64) -> Result<(), ShelfError> {
        let joint = &self.about.joint;
        let journal = match &mut self.journal {
            Some(journal) => journal,
            None => {
                let folder = shelf.begin(&self.name, &self.about)?;
                let journal = Journal::begin(&folder, &self.log, joint, epoch)?;
                self.journal.insert(journal)
            }
        };
        Ok(journal.write(&self.log, joint)?)
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
        let work = tokio::task::spawn_blocking(move || {
            let all = running.iter_mut();
            all.for_each(|one| one.write_down(&shelf, epoch));
            running
        });
        match work.await {
            Ok(running) => self.running = running,
            Err(error) => tracing::error!(%error, "what was being recorded is lost"),
        }
    }
}

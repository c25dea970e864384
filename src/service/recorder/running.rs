//! A running recording.

use std::sync::Arc;

use super::journal::Journal;
use super::log::Log;
use super::{About, MCAP, Shelf, ShelfError};
use crate::service::contract::{DiskPart, Handle, RecordingNews, Snapshot};

/// A running recording.
pub struct Running {
    /// Number of the move; `None` for a recording on demand.
    pub id: Option<u64>,
    /// Its intended name.
    pub name: String,
    /// Its subject.
    pub about: About,
    /// The samples so far.
    pub log: Log,
    /// Its file on the disk so far; `None` before the first, and if the disk has refused it.
    pub journal: Option<Journal>,
    /// Whether it cannot be written during the recording for another reason than the disk.
    pub unwritable: bool,
    /// Whether its description is on the disk.
    pub described: bool,
    /// Whether the engine was told that it is on the disk.
    pub told: bool,
    /// Time at which it is complete, s on the service's clock.
    pub until: f64,
}

impl Running {
    /// A new recording.
    pub fn new(id: Option<u64>, name: String, about: About, log: Log) -> Self {
        Self {
            id,
            name,
            about,
            log,
            journal: None,
            unwritable: false,
            described: false,
            told: false,
            until: f64::INFINITY,
        }
    }

    /// Adds the present knowledge about its joint.
    pub fn know(&mut self, now: &Snapshot) {
        let mut joints = now.joints.iter();
        if let Some(joint) = joints.find(|joint| joint.name == self.about.joint) {
            self.log.know(now.time_s, joint);
        }
    }

    /// Tells the engine whether it is on the disk, if that has changed.
    pub fn tell(&mut self, handle: &Handle) {
        let is_there = self.journal.is_some();
        if let Some(move_id) = self.id
            && self.told != is_there
        {
            self.told = is_there;
            let name = self.name.clone();
            handle.tell(match is_there {
                true => RecordingNews::Kept { move_id, name },
                false => RecordingNews::Gone { name },
            });
        }
    }

    /// Writes the samples since the last call. If the disk refuses, the recording is begun again on it when
    /// there is room, and is still stored at its end.
    fn write_down(&mut self, shelf: &Shelf, epoch: f64) {
        let no_room = self.journal.is_none() && shelf.disk().is_failing(DiskPart::Recordings);
        if self.unwritable || no_room || !self.log.is_measured() {
            return;
        }
        let grows = self.journal.is_some();
        let written = self.try_to_write_down(shelf, epoch);
        if written.is_ok() && grows {
            // An open file takes more even where its folder is gone: only a new file says that the disk works.
            return;
        }
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
            Some(journal) => journal.write_more(&self.log, joint)?,
            None => {
                let path = shelf.unfinished(&self.name).join(MCAP);
                let journal = Journal::begin(shelf.disk(), &path, &self.log, joint, epoch)?;
                self.journal = Some(journal);
            }
        }
        Ok(())
    }
}

/// Writes the new samples of all recordings, on a thread that may block, and tells the engine which ones are on
/// the disk. `epoch` is the Unix time of the service's clock's zero, s.
pub async fn write_down(
    mut all: Vec<Running>,
    shelf: &Arc<Shelf>,
    epoch: f64,
    handle: &Handle,
) -> Vec<Running> {
    let names: Vec<_> = all.iter().map(|one| one.name.clone()).collect();
    let its_shelf = Arc::clone(shelf);
    let work = tokio::task::spawn_blocking(move || {
        all.iter_mut()
            .for_each(|one| one.write_down(&its_shelf, epoch));
        all
    });
    let mut all = work.await.unwrap_or_else(|error| {
        tracing::error!(%error, "what was being recorded is lost");
        for name in names {
            shelf.disk().lost_recording();
            handle.tell(RecordingNews::Gone { name });
        }
        Vec::new()
    });
    all.iter_mut().for_each(|one| one.tell(handle));
    all
}

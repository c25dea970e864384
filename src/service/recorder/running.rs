//! One recording that is being made.

use super::journal::Journal;
use super::log::Log;
use super::shelf::About;
use crate::service::contract::{Handle, RecordingNews};

/// One recording that is being made.
pub struct Running {
    /// Number of the move; none where it was asked for.
    pub id: Option<u64>,
    /// Name that it shall have.
    pub name: String,
    /// What it is of.
    pub about: About,
    /// What has come.
    pub log: Log,
    /// What is on the disk of it so far; none before the first, and where the disk has refused it.
    pub journal: Option<Journal>,
    /// Whether it cannot be written down while it is made, for another reason than the disk.
    pub unwritable: bool,
    /// Whether the disk knows what it is of.
    pub described: bool,
    /// Whether the engine was told that it is on the disk.
    pub told: bool,
    /// Time at which it is complete, s on the service's clock.
    pub until: f64,
}

impl Running {
    /// One that begins.
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

    /// Tells the engine whether it is on the disk, where that has changed.
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
}

//! The data that outlives the process, opened together: state and recordings, brought in line with one another.

use std::sync::Arc;

use super::config::Config;
use super::disk::Disk;
use super::recorder::{Bounds, Shelf, ShelfError};
use super::state::{State, StateFile};

/// State and recordings of a data folder.
pub struct Kept {
    /// The recordings; none where nothing is recorded.
    pub shelf: Option<Arc<Shelf>>,
    /// Where the state is kept.
    pub file: StateFile,
    /// The state, which names no recording that is not there.
    pub state: State,
}

impl Kept {
    /// Opens what a configuration names. Recordings first: what an earlier life of the service left
    /// unfinished is put in order before the state is asked which recordings it names.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder of recordings cannot be made or read.
    pub fn open(config: &Config, disk: &Disk) -> Result<Self, ShelfError> {
        let recording = &config.recording;
        let bounds = Bounds {
            bytes: recording.max_bytes,
            count: recording.max_count,
            last: recording.keep_last,
        };
        let shelf = match recording.enabled {
            true => Some(Shelf::on(&recording.folder, bounds, disk.clone())?),
            false => None,
        };
        let file = StateFile::within(&config.data, disk.clone());
        let mut state = file.load();
        state.starts += 1;
        if let Some(shelf) = &shelf {
            state.agree_with(|name| shelf.path(name).is_ok(), shelf.last_move()?);
        }
        Ok(Self {
            shelf: shelf.map(Arc::new),
            file,
            state,
        })
    }
}

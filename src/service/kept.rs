//! State and recordings, the data that outlive the process, opened together and made consistent.

use std::sync::Arc;

use super::config::Config;
use super::disk::Disk;
use super::recorder::{Bounds, Shelf, ShelfError};
use super::state::{State, StateFile};

/// State and recordings of a data folder.
pub struct Kept {
    /// The recordings; `None` if recording is off.
    pub shelf: Option<Arc<Shelf>>,
    /// The file of the state.
    pub file: StateFile,
    /// The state; it names existing recordings only.
    pub state: State,
}

impl Kept {
    /// Opens the data of a configuration. The recordings come first: those that an earlier process left
    /// unfinished are put in order before the state is compared with them.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder of recordings cannot be created or read.
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
        let mut state = file.load(config.period);
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

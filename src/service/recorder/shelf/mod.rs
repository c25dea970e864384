//! The folder of recordings: its content, new recordings, and removals.
//!
//! A recording is written in a hidden folder and gets its name when it is complete. A kill at any instant
//! leaves the shelf in its old or its new state, and the hidden folder for the next start.

mod about;
mod archive;
mod draft;
mod salvage;
mod tidy;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use thiserror::Error;

use about::{ABOUT, is_name};
pub use about::{About, Entry, RecordingEnd, name_of};
pub use archive::Archive;
pub use draft::Draft;
pub use tidy::Bounds;

use super::MCAP;
use crate::recording::RecordingError;
use crate::service::contract::DiskPart;
use crate::service::disk::{Disk, beside, make_folder};

/// Prefix of incomplete recordings; no recording has such a name.
const UNFINISHED: &str = ".unfinished-";
/// Prefix of unreadable ones that were set aside.
const UNREADABLE: &str = ".unreadable-";
/// Prefix of those that are being removed.
const LEAVING: &str = ".leaving-";
/// The original of a file that was damaged in the middle.
const DAMAGED: &str = "damaged.mcap";
/// Prefix of the recorder's names of moves; the number follows.
const MOVE: &str = "move-";
/// Bytes that are written as a test for room: the size of a recorded move.
const PROBE: usize = 160_000;

/// Why a recording is not available.
#[derive(Debug, Error)]
pub enum ShelfError {
    /// No recording has that name.
    #[error("there is no recording \"{name}\"")]
    Unknown {
        /// The name asked for.
        name: String,
    },
    /// It is still being made.
    #[error("the recording \"{name}\" is not finished yet")]
    Unfinished {
        /// The name asked for.
        name: String,
    },
    /// It is no valid recording.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The disk refuses.
    #[error("{path}: {source}", path = path.display())]
    Disk {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
}

impl ShelfError {
    /// Whether the disk refused; otherwise something is missing or no valid recording.
    pub fn is_disk(&self) -> bool {
        match self {
            Self::Disk { .. } => true,
            Self::Recording(error) => error.is_io(),
            Self::Unknown { .. } | Self::Unfinished { .. } => false,
        }
    }
}

/// The name of a move's recording.
pub fn name_of_move(id: u64) -> String {
    format!("{MOVE}{id:06}")
}

/// The folder of recordings, each a folder of its own.
#[derive(Debug)]
pub struct Shelf {
    folder: PathBuf,
    bounds: Bounds,
    disk: Disk,
    /// Number of the next recording.
    next: AtomicU64,
}

impl Shelf {
    /// As [`Shelf::on`], with a disk of its own.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be created or read.
    pub fn open(folder: &Path, bounds: Bounds) -> Result<Self, ShelfError> {
        Self::on(folder, bounds, Disk::default())
    }

    /// Opens a folder, which is created if needed. Recordings that an earlier process left unfinished are
    /// stored on the shelf as far as they were written; unreadable ones are set aside. If the disk refuses,
    /// that is reported, and tried again when there is room.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be created or read.
    pub fn on(folder: &Path, bounds: Bounds, disk: Disk) -> Result<Self, ShelfError> {
        make_folder(folder).map_err(|source| self::disk(folder, source))?;
        let shelf = Self {
            folder: folder.into(),
            bounds,
            disk,
            next: AtomicU64::new(1),
        };
        shelf.count()?;
        shelf.remove_leaving()?;
        // The disk keeps an error here; it does not prevent the start.
        let _ = shelf.told(shelf.salvage(&[], &[]).and_then(|_| shelf.check()));
        if let Err(error) = shelf.tidy() {
            tracing::warn!(%error, "recordings take more than they may");
        }
        Ok(shelf)
    }

    /// Continues from the highest existing number.
    fn count(&self) -> Result<(), ShelfError> {
        let shelved = self.list()?.into_iter().map(|entry| entry.about.number);
        let hidden = [UNFINISHED, UNREADABLE].map(|beginning| self.hidden(beginning));
        let mut highest = shelved.max().unwrap_or(0);
        for folder in hidden.into_iter().collect::<Result<Vec<_>, _>>()?.concat() {
            highest = highest.max(about::read(&folder).map_or(0, |about| about.number));
        }
        self.next.store(highest.saturating_add(1), Relaxed);
        Ok(())
    }

    /// The number of a new recording.
    pub fn number(&self) -> u64 {
        self.next.fetch_add(1, Relaxed)
    }

    /// Its disk.
    pub fn disk(&self) -> &Disk {
        &self.disk
    }

    /// Notes the result of a write in the disk: where the folder itself is the matter, that. An invalid
    /// recording is no error of the disk.
    ///
    /// # Errors
    /// That of the folder, or of the attempt.
    pub fn told<T>(&self, result: Result<T, ShelfError>) -> Result<T, ShelfError> {
        let result = match result {
            Err(error) if !error.is_disk() => return Err(error),
            Err(error) => self.look().and(Err(error)),
            result => result,
        };
        self.disk.told(DiskPart::Recordings, result)
    }

    /// Looks at the folder, without a write.
    fn look(&self) -> Result<(), ShelfError> {
        let looked = self.disk.storage().look(&self.folder, PROBE as u64);
        looked.map_err(|source| disk(&self.folder, source))
    }

    /// The recordings, oldest first.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be read.
    pub fn list(&self) -> Result<Vec<Entry>, ShelfError> {
        let entries = fs::read_dir(&self.folder).map_err(|source| disk(&self.folder, source))?;
        let entries = entries.flatten();
        let mut list: Vec<_> = entries.filter_map(|one| Entry::of(&one.path())).collect();
        list.sort_by(Entry::order);
        Ok(list)
    }

    /// The highest number of an existing move, finished or not; 0 without any.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be read.
    pub fn last_move(&self) -> Result<u64, ShelfError> {
        let entries = fs::read_dir(&self.folder).map_err(|source| disk(&self.folder, source))?;
        let number = |name: &str| -> Option<u64> {
            let name = [UNFINISHED, UNREADABLE]
                .iter()
                .fold(name, |name, hidden| name.trim_start_matches(hidden));
            let digits = name.strip_prefix(MOVE)?;
            digits.split('-').next()?.parse().ok()
        };
        let numbers = entries
            .flatten()
            .filter_map(|entry| number(&entry.file_name().to_string_lossy()));
        Ok(numbers.max().unwrap_or(0))
    }

    /// The folder of a recording.
    ///
    /// A name consists of letters, digits, `-`, `_` and dots that are not first, so that no request can leave
    /// the shelf.
    ///
    /// # Errors
    /// [`ShelfError::Unknown`] where there is none of that name, [`ShelfError::Unfinished`] where it is
    /// incomplete.
    pub fn path(&self, name: &str) -> Result<PathBuf, ShelfError> {
        let path = self.folder.join(name);
        match is_name(name) {
            true if path.join(ABOUT).is_file() => Ok(path),
            true if self.unfinished(name).is_dir() => {
                Err(ShelfError::Unfinished { name: name.into() })
            }
            _ => Err(ShelfError::Unknown { name: name.into() }),
        }
    }

    /// The subject of a recording.
    ///
    /// # Errors
    /// As [`Shelf::path`].
    pub fn about(&self, name: &str) -> Result<About, ShelfError> {
        let path = self.path(name)?;
        about::read(&path).map_err(|source| disk(&path, source))
    }

    /// Creates the folder of a running recording, or updates its description; [`Shelf::put`] completes it.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the disk refuses.
    pub fn begin(&self, name: &str, about: &About) -> Result<PathBuf, ShelfError> {
        let folder = self.unfinished(&name_of(name));
        let storage = self.disk.storage();
        storage
            .create_folder(&folder)
            .map_err(|source| disk(&folder, source))?;
        let path = folder.join(ABOUT);
        let text = serde_json::to_vec_pretty(about).map_err(|error| disk(&path, error.into()))?;
        let written = self.disk.write_whole(&path, &text);
        written.map_err(|source| disk(&path, source))?;
        Ok(folder)
    }

    /// An unused name, also among unfinished recordings: this one, or with a number appended.
    pub fn free_name(&self, name: &str) -> String {
        let name = name_of(name);
        let numbered = (2..).map(|count: u32| format!("{name}-{count}"));
        let mut names = [name.clone()].into_iter().chain(numbered);
        let free =
            |name: &String| !self.folder.join(name).exists() && !self.unfinished(name).exists();
        names.find(free).unwrap_or_default()
    }

    /// Folder of a recording before it is on the shelf.
    pub fn unfinished(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{UNFINISHED}{name}"))
    }

    /// Stores a recording on the shelf, completely or not at all; returns its name. `write` fills its folder.
    /// If the name is in use, a number is appended.
    ///
    /// # Errors
    /// [`ShelfError`] where it is no valid recording, or the disk refuses. The file that has grown with the
    /// recording is then still there for [`Shelf::salvage`].
    pub fn put(
        &self,
        name: &str,
        about: &About,
        write: impl FnOnce(&Draft) -> Result<(), RecordingError>,
    ) -> Result<String, ShelfError> {
        let mut about = about.clone();
        if about.number == 0 {
            about.number = self.number();
        }
        let folder = self.begin(name, &about)?;
        let draft = Draft {
            folder: &folder,
            disk: &self.disk,
        };
        let result = write(&draft)
            .map_err(ShelfError::from)
            .and_then(|()| self.shelve(&name_of(name), &folder));
        if result.is_err() {
            self.keep_what_has_grown(&folder);
        }
        result
    }

    /// Renames a complete folder, once all its content is durable.
    fn shelve(&self, name: &str, folder: &Path) -> Result<String, ShelfError> {
        let storage = self.disk.storage();
        let path = self.free(name);
        let renamed = (|| {
            for file in fs::read_dir(folder)? {
                storage.sync(&file?.path())?;
            }
            for file in [MCAP, DAMAGED] {
                let (file, whole) = (folder.join(file), beside(&folder.join(file)));
                if whole.exists() {
                    storage.rename(&whole, &file)?;
                }
            }
            storage.sync(folder)?;
            storage.rename(folder, &path)
        })();
        renamed.map_err(|source| disk(folder, source))?;
        if let Err(error) = storage.sync(&self.folder) {
            // It is on the shelf; after a power failure it may still be among the unfinished ones.
            tracing::warn!(%error, "{}", self.folder.display());
        }
        Ok(path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into())
    }

    /// Removes files that were written in vain. If nothing had grown, nothing is left.
    fn keep_what_has_grown(&self, folder: &Path) {
        let storage = self.disk.storage();
        let has_grown = folder.join(MCAP).is_file();
        let files = fs::read_dir(folder).into_iter().flatten().flatten();
        let in_vain = |path: &PathBuf| ![MCAP, ABOUT].iter().any(|kept| path.ends_with(kept));
        let result = match has_grown {
            true => files
                .map(|file| file.path())
                .filter(in_vain)
                .try_for_each(|file| storage.remove(&file)),
            false => storage.remove(folder),
        };
        if let Err(error) = result {
            tracing::debug!(%error, "{}: the next attempt will do it", folder.display());
        }
    }

    /// An unused folder of this name, or with a number appended.
    fn free(&self, name: &str) -> PathBuf {
        let numbered = (2..).map(|count: u32| self.folder.join(format!("{name}-{count}")));
        let mut paths = [self.folder.join(name)].into_iter().chain(numbered);
        paths.find(|path| !path.exists()).unwrap_or_default()
    }

    /// Looks whether a recording could be made. Only where the look says no does a write decide: free room may
    /// be reserved for the user of this service.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where none could be made.
    pub fn check(&self) -> Result<(), ShelfError> {
        self.look().or_else(|_| self.probe())
    }

    /// Tests for room, by writing as much as a recorded move takes.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where there is none.
    pub fn probe(&self) -> Result<(), ShelfError> {
        // After a kill the next start removes it.
        let path = self.folder.join(format!("{LEAVING}probe"));
        let storage = self.disk.storage();
        let written = storage.create(&path).and_then(|mut file| {
            file.write_all(&[0; PROBE])?;
            file.flush()?;
            storage.sync(&path)
        });
        // If it was not created, there is nothing to remove.
        let removed = storage.remove(&path);
        written.and(removed).map_err(|source| disk(&path, source))
    }
}

fn disk(path: &Path, source: io::Error) -> ShelfError {
    ShelfError::Disk {
        path: path.into(),
        source,
    }
}

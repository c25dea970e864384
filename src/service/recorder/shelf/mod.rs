//! The folder of recordings: what is in it, what goes in, what has to go.
//!
//! A recording is made in a hidden folder and takes its name when it is whole. A kill at any instant
//! leaves the shelf as it was before or after, and the hidden folder for the next start.

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
pub use about::{About, Entry, name_of};
pub use archive::Archive;
pub use draft::Draft;
pub use tidy::Bounds;

use super::MCAP;
use crate::recording::RecordingError;
use crate::service::contract::DiskPart;
use crate::service::disk::{Disk, beside};

/// Beginning of what is not yet whole; no recording has such a name.
const UNFINISHED: &str = ".unfinished-";
/// Beginning of what could not be read and was set aside.
const UNREADABLE: &str = ".unreadable-";
/// Beginning of what is being removed.
const LEAVING: &str = ".leaving-";
/// A file as it was found, where something in the middle of it was damaged.
const DAMAGED: &str = "damaged.mcap";
/// How the recorder calls moves; the number follows.
const MOVE: &str = "move-";
/// Bytes that are written to see whether there is room: as much as a recorded move takes.
const PROBE: usize = 160_000;

/// Why a recording is not to be had.
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
    /// The recording is not one.
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
    /// Whether the disk refused, rather than that something is not there or no recording.
    pub fn is_disk(&self) -> bool {
        match self {
            Self::Disk { .. } => true,
            Self::Recording(error) => error.is_io(),
            Self::Unknown { .. } | Self::Unfinished { .. } => false,
        }
    }
}

/// How the recording of a move is called.
pub fn name_of_move(id: u64) -> String {
    format!("{MOVE}{id:06}")
}

/// The folder of recordings, each a folder of its own.
#[derive(Debug)]
pub struct Shelf {
    folder: PathBuf,
    bounds: Bounds,
    disk: Disk,
    /// Number of the recording that begins next.
    next: AtomicU64,
}

impl Shelf {
    /// As [`Shelf::on`], on a disk of its own.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be made or read.
    pub fn open(folder: &Path, bounds: Bounds) -> Result<Self, ShelfError> {
        Self::on(folder, bounds, Disk::default())
    }

    /// Takes a folder, which is made where needed. What an earlier life of the service did not finish
    /// there is put onto the shelf as far as it came; what cannot be read is set aside. Where the disk
    /// refuses that it is told, and tried again when there is room.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be made or read.
    pub fn on(folder: &Path, bounds: Bounds, disk: Disk) -> Result<Self, ShelfError> {
        fs::create_dir_all(folder).map_err(|source| self::disk(folder, source))?;
        let shelf = Self {
            folder: folder.into(),
            bounds,
            disk,
            next: AtomicU64::new(1),
        };
        shelf.count()?;
        shelf.remove_leaving()?;
        // What goes wrong here is known to the disk now, and no reason not to start.
        let _ = shelf.told(shelf.salvage(&[]));
        if let Err(error) = shelf.tidy() {
            tracing::warn!(%error, "recordings take more than they may");
        }
        Ok(shelf)
    }

    /// Counts on from the highest number that is there.
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

    /// The number of a recording that begins now.
    pub fn number(&self) -> u64 {
        self.next.fetch_add(1, Relaxed)
    }

    /// The disk that it writes to.
    pub fn disk(&self) -> &Disk {
        &self.disk
    }

    /// Has the disk remember how an attempt to write went. That something is no recording is not the
    /// disk's matter.
    ///
    /// # Errors
    /// That of the attempt.
    pub fn told<T>(&self, result: Result<T, ShelfError>) -> Result<T, ShelfError> {
        match &result {
            Err(error) if !error.is_disk() => result,
            _ => self.disk.told(DiskPart::Recordings, result),
        }
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

    /// The highest number of a move that is there, finished or not; 0 where there is none.
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
    /// A name is letters, digits, `-`, `_` and dots that do not lead, so that it cannot lead out of
    /// the shelf, whatever a request asks for.
    ///
    /// # Errors
    /// [`ShelfError::Unknown`] where there is none of that name, [`ShelfError::Unfinished`] where it is
    /// still being made.
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

    /// Makes the folder of a recording that is being made, or says anew what it is of;
    /// [`Shelf::put`] finishes it.
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

    /// A name that no recording has, finished or not: this one, or with a number behind it.
    pub fn free_name(&self, name: &str) -> String {
        let name = name_of(name);
        let numbered = (2..).map(|count: u32| format!("{name}-{count}"));
        let mut names = [name.clone()].into_iter().chain(numbered);
        let free =
            |name: &String| !self.folder.join(name).exists() && !self.unfinished(name).exists();
        names.find(free).unwrap_or_default()
    }

    /// Where a recording is made, before it is on the shelf.
    pub fn unfinished(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{UNFINISHED}{name}"))
    }

    /// Puts a recording onto the shelf, whole or not at all; says under which name. `write` fills its
    /// folder. Where the name is taken, a number is added to it.
    ///
    /// # Errors
    /// [`ShelfError`] where it is no recording, or the disk refuses. What had grown on the disk with
    /// the recording is still there then, for [`Shelf::salvage`].
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

    /// Gives a folder that is filled its name, once everything in it is on the medium.
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
            // It is on the shelf; a power failure may still put it back among the unfinished.
            tracing::warn!(%error, "{}", self.folder.display());
        }
        Ok(path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into())
    }

    /// Takes away what was written in vain. Where nothing had grown, nothing is left.
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

    /// A folder of this name, or with a number behind it, that is not there yet.
    fn free(&self, name: &str) -> PathBuf {
        let numbered = (2..).map(|count: u32| self.folder.join(format!("{name}-{count}")));
        let mut paths = [self.folder.join(name)].into_iter().chain(numbered);
        paths.find(|path| !path.exists()).unwrap_or_default()
    }

    /// Looks whether there is room again, by writing as much as a recorded move takes.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where there is none.
    pub fn probe(&self) -> Result<(), ShelfError> {
        // A kill in its midst leaves what goes at the next start.
        let path = self.folder.join(format!("{LEAVING}probe"));
        let storage = self.disk.storage();
        let written = storage.create(&path).and_then(|mut file| {
            file.write_all(&[0; PROBE])?;
            file.flush()?;
            storage.sync(&path)
        });
        // Where it was not made there is nothing to remove.
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

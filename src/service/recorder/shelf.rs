//! The folder of recordings: what is in it, what goes in, what has to go.

use serde::{Deserialize, Serialize};
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use thiserror::Error;

use super::MCAP;
use crate::recording::{Recording, RecordingError, Role};
use crate::service::contract::{ModeValue, MoveResult};

/// The file that says what a recording is of, beside its manifest.
const ABOUT: &str = "about.json";
/// Beginning of what is not yet whole; no recording has such a name.
const UNFINISHED: &str = ".unfinished-";
/// The longest name, bytes: file systems take 255, and some letters are put before and behind it.
const LONGEST_NAME: usize = 128;

/// Why a recording is not to be had.
#[derive(Debug, Error)]
pub enum ShelfError {
    /// No recording has that name.
    #[error("there is no recording \"{name}\"")]
    Unknown {
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
        /// What the system says.
        source: io::Error,
    },
}

/// What a recording is of.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct About {
    /// The joint.
    pub joint: String,
    /// When it began, seconds since 1970.
    pub unix_time_s: f64,
    /// How long it is, s.
    pub duration_s: f64,
    /// Mode that was shaped for at its end.
    pub mode: Option<ModeValue>,
    /// Payload of the embedded arm, kg.
    pub payload_kg: Option<f64>,
    /// What the move left; absent where the recording was made on demand, or the service was killed.
    pub result: Option<MoveResult>,
    /// Batches that were lost while it was made.
    pub batches_lost: u64,
}

/// A recording of the list.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    /// Name.
    pub name: String,
    /// Bytes on disk.
    pub bytes: u64,
    /// What it is of.
    #[serde(flatten)]
    pub about: About,
    #[serde(skip)]
    written: SystemTime,
}

/// What recordings may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Bytes of all together.
    pub bytes: u64,
    /// Age at which one goes.
    pub age: Duration,
}

/// The folder of recordings, each a folder of its own.
#[derive(Clone, Debug)]
pub struct Shelf {
    folder: PathBuf,
    bounds: Bounds,
}

impl Shelf {
    /// Takes a folder, which is made where needed. What an earlier life of the service did not finish
    /// there is kept as far as it came, or removed where nothing can be read.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be made or read.
    pub fn open(folder: &Path, bounds: Bounds) -> Result<Self, ShelfError> {
        fs::create_dir_all(folder).map_err(|source| disk(folder, source))?;
        let shelf = Self {
            folder: folder.into(),
            bounds,
        };
        for entry in fs::read_dir(folder).map_err(|source| disk(folder, source))? {
            let path = entry.map_err(|source| disk(folder, source))?.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if let Some(name) = name.strip_prefix(UNFINISHED)
                && let Err(error) = shelf.salvage(name, &path)
            {
                tracing::warn!(name, %error, "nothing is left of a recording");
                // Where it was put in order and could not be kept, it is gone already.
                if path.exists() {
                    fs::remove_dir_all(&path).map_err(|source| disk(&path, source))?;
                }
            }
        }
        shelf.tidy()?;
        Ok(shelf)
    }

    /// What is there, oldest first.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be read.
    pub fn list(&self) -> Result<Vec<Entry>, ShelfError> {
        let entries = fs::read_dir(&self.folder).map_err(|source| disk(&self.folder, source))?;
        let mut list: Vec<_> = entries
            .flatten()
            .filter_map(|one| entry(&one.path()))
            .collect();
        list.sort_by(|a, b| (a.written, &a.name).cmp(&(b.written, &b.name)));
        Ok(list)
    }

    /// The folder of a recording.
    ///
    /// A name is letters, digits, `-`, `_` and dots that do not lead, so that it cannot lead out of
    /// the shelf, whatever a request asks for.
    ///
    /// # Errors
    /// [`ShelfError::Unknown`] where there is none of that name.
    pub fn path(&self, name: &str) -> Result<PathBuf, ShelfError> {
        let path = self.folder.join(name);
        match is_name(name) && path.join(ABOUT).is_file() {
            true => Ok(path),
            false => Err(ShelfError::Unknown { name: name.into() }),
        }
    }

    /// What a recording is of.
    ///
    /// # Errors
    /// [`ShelfError::Unknown`] where there is none of that name.
    pub fn about(&self, name: &str) -> Result<About, ShelfError> {
        let unknown = || ShelfError::Unknown { name: name.into() };
        entry(&self.path(name)?)
            .map(|entry| entry.about)
            .ok_or_else(unknown)
    }

    /// Makes the folder of a recording that is being made; [`Shelf::put`] finishes it.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the disk refuses.
    pub fn begin(&self, name: &str, about: &About) -> Result<PathBuf, ShelfError> {
        let folder = self.unfinished(&name_of(name));
        fs::create_dir_all(&folder).map_err(|source| disk(&folder, source))?;
        describe(about, &folder)?;
        Ok(folder)
    }

    fn unfinished(&self, name: &str) -> PathBuf {
        self.folder.join(format!("{UNFINISHED}{name}"))
    }

    /// Puts what a recording has become before the service was killed onto the shelf.
    fn salvage(&self, name: &str, folder: &Path) -> Result<(), ShelfError> {
        let recording = Recording::from_path(folder.join(MCAP))?;
        let mut about = about(folder).map_err(|source| disk(folder, source))?;
        let command = recording.channel(Role::CommandPosition);
        let ends = command.and_then(|command| Some((command.time.first()?, command.time.last()?)));
        about.duration_s = ends.map_or(0.0, |(first, last)| last - first);
        self.put(name, &about, |folder| recording.write(folder, true))
    }

    /// Puts a recording onto the shelf, whole or not at all, and removes the oldest where there are
    /// too many. `write` fills its folder. Where the name is taken (by an earlier life of the service,
    /// of which it knows nothing any more), a number is added to it.
    ///
    /// # Errors
    /// [`ShelfError`] where it is no recording, or the disk refuses.
    pub fn put(
        &self,
        name: &str,
        about: &About,
        write: impl FnOnce(&Path) -> Result<(), RecordingError>,
    ) -> Result<(), ShelfError> {
        let name = name_of(name);
        let unfinished = self.unfinished(&name);
        let result = write(&unfinished).map_err(ShelfError::from).and_then(|()| {
            describe(about, &unfinished)?;
            let path = self.free(&name);
            fs::rename(&unfinished, &path).map_err(|source| disk(&path, source))
        });
        if let Err(error) = result {
            // What is left of it would only take room; the error that matters is the first.
            let _ = fs::remove_dir_all(&unfinished);
            return Err(error);
        }
        self.tidy()
    }

    /// A folder of this name, or with a number behind it, that is not there yet.
    fn free(&self, name: &str) -> PathBuf {
        let numbered = (2..).map(|count: u32| self.folder.join(format!("{name}-{count}")));
        let mut paths = [self.folder.join(name)].into_iter().chain(numbered);
        paths.find(|path| !path.exists()).unwrap_or_default()
    }

    /// A recording as one file, a tar archive of its folder.
    ///
    /// # Errors
    /// [`ShelfError`] where there is none of that name, or it cannot be read.
    pub fn archive(&self, name: &str) -> Result<Vec<u8>, ShelfError> {
        let path = self.path(name)?;
        let mut archive = tar::Builder::new(Vec::new());
        archive.follow_symlinks(false);
        let result = archive.append_dir_all(name, &path);
        result
            .and_then(|()| archive.into_inner())
            .map_err(|source| disk(&path, source))
    }

    /// Removes what is too old, and the oldest until the rest is not too much.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be read or something not removed.
    pub fn tidy(&self) -> Result<(), ShelfError> {
        let list = self.list()?;
        let mut bytes: u64 = list.iter().map(|entry| entry.bytes).sum();
        for entry in list {
            let old = entry
                .written
                .elapsed()
                .is_ok_and(|age| age > self.bounds.age);
            if old || bytes > self.bounds.bytes {
                let path = self.folder.join(&entry.name);
                tracing::info!(name = entry.name, "a recording goes: too old, or too many");
                fs::remove_dir_all(&path).map_err(|source| disk(&path, source))?;
                bytes -= entry.bytes;
            }
        }
        Ok(())
    }
}

/// A name made of any text: what a name may not have becomes `_`.
pub fn name_of(text: &str) -> String {
    let fit = |c: char| if is_letter(c) { c } else { '_' };
    let name: String = text.chars().map(fit).take(LONGEST_NAME - 16).collect();
    match is_name(&name) {
        true => name,
        false => format!("_{name}"),
    }
}

fn is_letter(c: char) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.')
}

fn is_name(name: &str) -> bool {
    (1..=LONGEST_NAME).contains(&name.len())
        && name.chars().all(is_letter)
        && !name.starts_with('.')
}

fn describe(about: &About, folder: &Path) -> Result<(), ShelfError> {
    let path = folder.join(ABOUT);
    let text = serde_json::to_vec_pretty(about).map_err(|error| disk(&path, error.into()))?;
    fs::write(&path, text).map_err(|source| disk(&path, source))
}

/// The recording in a folder; none where there is no such thing, or it is on its way out.
fn entry(path: &Path) -> Option<Entry> {
    let name = path.file_name()?.to_str().filter(|name| is_name(name))?;
    let file = path.join(ABOUT);
    let sizes = fs::read_dir(path).ok()?.flatten();
    Some(Entry {
        name: name.into(),
        bytes: sizes
            .filter_map(|file| Some(file.metadata().ok()?.len()))
            .sum(),
        about: about(path).ok()?,
        written: file.metadata().and_then(|data| data.modified()).ok()?,
    })
}

fn about(folder: &Path) -> io::Result<About> {
    let text = fs::read(folder.join(ABOUT))?;
    Ok(serde_json::from_slice(&text).unwrap_or_default())
}

fn disk(path: &Path, source: io::Error) -> ShelfError {
    ShelfError::Disk {
        path: path.into(),
        source,
    }
}

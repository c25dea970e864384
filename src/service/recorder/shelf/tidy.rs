//! Removal of recordings when there are too many: the oldest by number first, never the last ones.

use std::fs;
use std::path::PathBuf;

use super::about::{self, Entry};
use super::{LEAVING, Shelf, ShelfError, UNREADABLE, disk};

/// Limits of the shelf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Most bytes of all together.
    pub bytes: u64,
    /// Most recordings.
    pub count: usize,
    /// Number of the last ones that always stay; at least the newest.
    pub last: usize,
}

/// A candidate for removal.
struct Old {
    path: PathBuf,
    bytes: u64,
    /// The name of a recording; `None` for one that was set aside.
    name: Option<String>,
}

impl Shelf {
    /// Removes the oldest recordings until the limits hold, and returns their names. Those that were set aside
    /// as unreadable go first.
    ///
    /// # Errors
    /// [`ShelfError::Disk`] where the folder cannot be read or a recording cannot be removed; the others have
    /// been removed then.
    pub fn tidy(&self) -> Result<Vec<String>, ShelfError> {
        let list = self.list()?;
        let aside = self.hidden(UNREADABLE)?;
        let aside = aside.into_iter().map(|path| Old {
            bytes: about::bytes(&path).unwrap_or(0),
            path,
            name: None,
        });
        let (mut bytes, mut count) = (0, list.len());
        let may_go = count.saturating_sub(self.bounds.last.max(1));
        let shelved = list.into_iter().map(|entry: Entry| Old {
            path: self.folder.join(&entry.name),
            bytes: entry.bytes,
            name: Some(entry.name),
        });
        let mut all: Vec<_> = aside.collect();
        let may_go = all.len() + may_go;
        all.extend(shelved);
        bytes += all.iter().map(|old| old.bytes).sum::<u64>();
        let (mut gone, mut failed) = (Vec::new(), None);
        for old in all.into_iter().take(may_go) {
            if bytes <= self.bounds.bytes && count <= self.bounds.count {
                break;
            }
            if old.name.is_none() && bytes <= self.bounds.bytes {
                // It is no recording, and does not count as one.
                continue;
            }
            tracing::info!(folder = %old.path.display(), "goes: recordings take more than they may");
            match self.remove(&old.path) {
                Ok(()) => {
                    bytes -= old.bytes;
                    count -= usize::from(old.name.is_some());
                    gone.extend(old.name);
                }
                Err(error) => failed = Some(error),
            }
        }
        failed.map_or(Ok(gone), Err)
    }

    /// Removes a folder. It is renamed first, so that a kill leaves no partial recording.
    pub(super) fn remove(&self, path: &std::path::Path) -> Result<(), ShelfError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let leaving = self.folder.join(format!("{LEAVING}{name}"));
        let storage = self.disk.storage();
        storage
            .rename(path, &leaving)
            .and_then(|()| storage.remove(&leaving))
            .map_err(|source| disk(path, source))
    }

    /// Removes folders whose removal was interrupted by a kill.
    pub(super) fn remove_leaving(&self) -> Result<(), ShelfError> {
        for path in self.hidden(LEAVING)? {
            if let Err(error) = self.disk.storage().remove(&path) {
                tracing::warn!(%error, "{} cannot be removed", path.display());
            }
        }
        Ok(())
    }

    /// Folders with this prefix, in the order of their numbers.
    pub(super) fn hidden(&self, beginning: &str) -> Result<Vec<PathBuf>, ShelfError> {
        let entries = fs::read_dir(&self.folder).map_err(|source| disk(&self.folder, source))?;
        let begins = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with(beginning)
        };
        let mut paths: Vec<_> = entries
            .flatten()
            .map(|entry| entry.path())
            .filter(begins)
            .collect();
        paths.sort_by_key(|path| (about::read(path).unwrap_or_default().number, path.clone()));
        Ok(paths)
    }
}

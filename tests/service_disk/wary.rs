//! A disk that looks whether what takes a name is on the medium.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use quell::recording::Sink;
use quell::service::disk::{FileSystem, Storage};

/// The file system, which panics where something takes a name that a power failure could leave empty.
#[derive(Debug, Default)]
pub struct Wary {
    unsynced: Mutex<BTreeSet<PathBuf>>,
    pub renamed: Mutex<Vec<PathBuf>>,
}

impl Storage for Wary {
    fn create(&self, path: &Path) -> io::Result<Sink> {
        self.unsynced.lock().expect("no panic").insert(path.into());
        FileSystem.create(path)
    }

    fn create_folder(&self, path: &Path) -> io::Result<()> {
        FileSystem.create_folder(path)
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        self.unsynced.lock().expect("no panic").remove(path);
        // A folder's names are on the medium with it.
        let mut renamed = self.renamed.lock().expect("no panic");
        renamed.retain(|to| to.parent() != Some(path));
        FileSystem.sync(path)
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        let unsynced = self.unsynced.lock().expect("no panic");
        let left = unsynced.iter().find(|path| path.starts_with(from));
        assert_eq!(left, None, "{} takes a name", from.display());
        self.renamed.lock().expect("no panic").push(to.into());
        FileSystem.rename(from, to)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        let mut unsynced = self.unsynced.lock().expect("no panic");
        unsynced.retain(|one| !one.starts_with(path));
        let mut renamed = self.renamed.lock().expect("no panic");
        renamed.retain(|one| !one.starts_with(path));
        FileSystem.remove(path)
    }

    fn look(&self, folder: &Path, room: u64) -> io::Result<()> {
        FileSystem.look(folder, room)
    }
}

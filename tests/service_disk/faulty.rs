//! A disk that refuses, and one that looks whether what takes a name is on the medium.

use std::collections::BTreeSet;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use quell::recording::Sink;
use quell::service::disk::{FileSystem, Storage};

/// Whether a call, counted from 0, that concerns a path is refused.
type Refuses = Box<dyn Fn(u64, &Path) -> bool + Send>;

/// The file system, which says that it is full when it is told to.
#[derive(Clone)]
pub struct Faulty(Arc<Mutex<(u64, Refuses)>>);

impl fmt::Debug for Faulty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Faulty")
    }
}

impl Faulty {
    pub fn new(refuses: impl Fn(u64, &Path) -> bool + Send + 'static) -> Self {
        Self(Arc::new(Mutex::new((0, Box::new(refuses)))))
    }

    /// From now on.
    pub fn refuse(&self, refuses: impl Fn(u64, &Path) -> bool + Send + 'static) {
        self.0.lock().expect("no panic").1 = Box::new(refuses);
    }

    /// Calls so far.
    pub fn calls(&self) -> u64 {
        self.0.lock().expect("no panic").0
    }

    fn allows(&self, path: &Path) -> io::Result<()> {
        let mut inside = self.0.lock().expect("no panic");
        let call = inside.0;
        inside.0 += 1;
        match (inside.1)(call, path) {
            true => Err(io::ErrorKind::StorageFull.into()),
            false => Ok(()),
        }
    }
}

impl Storage for Faulty {
    fn create(&self, path: &Path) -> io::Result<Sink> {
        self.allows(path)?;
        Ok(Box::new(File {
            inside: FileSystem.create(path)?,
            path: path.into(),
            disk: self.clone(),
        }))
    }

    fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.allows(path)?;
        FileSystem.create_folder(path)
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        self.allows(path)?;
        FileSystem.sync(path)
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.allows(from)?;
        FileSystem.rename(from, to)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        self.allows(path)?;
        FileSystem.remove(path)
    }
}

struct File {
    inside: Sink,
    path: PathBuf,
    disk: Faulty,
}

impl Write for File {
    /// A disk takes the beginning of what it has no room for.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if let Err(full) = self.disk.allows(&self.path) {
            self.inside.write_all(&bytes[..bytes.len() / 2])?;
            return Err(full);
        }
        self.inside.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inside.flush()
    }
}

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
}

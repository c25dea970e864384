//! A disk that refuses.

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
            full: false,
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

    fn look(&self, folder: &Path, room: u64) -> io::Result<()> {
        FileSystem.look(folder, room)
    }
}

struct File {
    inside: Sink,
    path: PathBuf,
    disk: Faulty,
    /// Whether it has taken the beginning of something only.
    full: bool,
}

impl Write for File {
    /// A disk takes the beginning of what it has no room for, and refuses the rest when that comes.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if std::mem::take(&mut self.full) {
            return Err(io::ErrorKind::StorageFull.into());
        }
        match self.disk.allows(&self.path) {
            Ok(()) => self.inside.write(bytes),
            Err(full) if bytes.len() < 2 => Err(full),
            Err(_) => {
                self.full = true;
                self.inside.write(&bytes[..bytes.len() / 2])
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inside.flush()
    }
}

//! The data folder: its lock, its writes, and their errors.
//!
//! All stored data go through one [`Disk`]. A [`Storage`] does the work, so that a test can simulate a full
//! disk at any call. An error is kept until a write succeeds again: state, metrics, page and log report it.
//!
//! `docs/src/guide/disk.md` describes which data are lost when.

mod health;
mod lock;
mod storage;

use std::fmt::Display;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::clock::ServiceClock;
use super::contract::{DiskPart, DiskView};
use health::Health;
pub use lock::FolderError;
use lock::Lock;
pub use storage::{FileSystem, Storage, make_folder};

/// Access to the disk; cheap to clone. While a clone lives, the lock on the folder is held.
#[derive(Clone, Debug)]
pub struct Disk {
    storage: Arc<dyn Storage>,
    clock: ServiceClock,
    health: Arc<Mutex<Health>>,
    /// Held as long as something may be written.
    _lock: Option<Arc<Lock>>,
}

impl Default for Disk {
    fn default() -> Self {
        Self::new(Arc::new(FileSystem))
    }
}

impl Disk {
    /// With this storage and the system's clock, without a lock.
    pub fn new(storage: Arc<dyn Storage>) -> Self {
        Self {
            storage,
            clock: ServiceClock::start(),
            health: Arc::default(),
            _lock: None,
        }
    }

    /// With this storage, as the only service of a folder, which is created if needed.
    ///
    /// # Errors
    /// [`FolderError`] where another service uses it, or it cannot be created.
    pub fn of(folder: &Path, storage: Arc<dyn Storage>) -> Result<Self, FolderError> {
        make_folder(folder).map_err(|error| FolderError::System {
            path: folder.into(),
            error,
        })?;
        let disk = Self::new(storage);
        let lock = Lock::take(folder, disk.clock.unix_time())?;
        Ok(Self {
            _lock: Some(Arc::new(lock)),
            ..disk
        })
    }

    /// The same with another clock, which gives the times of errors.
    pub fn on_clock(self, clock: ServiceClock) -> Self {
        Self { clock, ..self }
    }

    /// The operations themselves.
    pub fn storage(&self) -> &dyn Storage {
        &*self.storage
    }

    /// Writes a file atomically: a reader always finds the old or the new content, complete.
    ///
    /// # Errors
    /// The system's error. The old content is then still there.
    pub fn write_whole(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let beside = beside(path);
        let written = (|| {
            let mut file = self.storage.create(&beside)?;
            file.write_all(bytes)?;
            file.flush()?;
            drop(file);
            self.storage.sync(&beside)?;
            self.storage.rename(&beside, path)
        })();
        if let Err(error) = written {
            // It would only take room; if it cannot be removed, the next attempt replaces it.
            let _ = self.storage.remove(&beside);
            return Err(error);
        }
        match path.parent() {
            // The new name is durable only once its folder is synced.
            Some(folder) if !folder.as_os_str().is_empty() => self.storage.sync(folder),
            _ => self.storage.sync(Path::new(".")),
        }
    }

    /// Notes the result of a write, and returns it.
    ///
    /// # Errors
    /// That of the attempt.
    pub fn told<T, E: Display>(&self, what: DiskPart, result: Result<T, E>) -> Result<T, E> {
        match &result {
            Ok(_) => self.health().worked(what),
            Err(error) => {
                let now = self.clock.unix_time();
                self.health().failed(what, &error.to_string(), now);
            }
        }
        result
    }

    /// Counts a recording that is incomplete on the shelf.
    pub fn lost_recording(&self) {
        self.health().lost_recording();
    }

    /// Whether the last write failed.
    pub fn is_failing(&self, what: DiskPart) -> bool {
        self.health().is_failing(what)
    }

    /// Why the last write failed, as long as none has succeeded since.
    pub fn fault(&self, what: DiskPart) -> Option<String> {
        let view = self.health().view();
        let fault = view.faults.into_iter().find(|fault| fault.what == what);
        fault.map(|fault| fault.reason)
    }

    /// The view for clients.
    pub fn view(&self) -> DiskView {
        self.health().view()
    }

    fn health(&self) -> MutexGuard<'_, Health> {
        // Counts and texts are valid even if a thread panicked.
        self.health.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Temporary file that is written before it takes the final name.
pub fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".new");
    path.with_file_name(name)
}

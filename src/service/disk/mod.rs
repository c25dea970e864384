//! The data folder: who may write to it, how, and how well that goes.
//!
//! Everything that the service keeps goes through one [`Disk`]. A [`Storage`] does the work, so that a
//! test can have a disk that is full at any call. What fails is remembered until it works again: state,
//! metrics, page and log say so.
//!
//! `docs/src/guide/disk.md` tells what is lost when.

mod health;
mod lock;
mod storage;

use std::fmt::Display;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::clock::ServiceClock;
use super::contract::{DiskPart, DiskView};
use health::Health;
pub use lock::FolderError;
use lock::Lock;
pub use storage::{FileSystem, Storage};

/// The way to the disk; cheap to clone. As long as one clone lives, the lock on the folder is held.
#[derive(Clone, Debug)]
pub struct Disk {
    storage: Arc<dyn Storage>,
    clock: ServiceClock,
    health: Arc<Mutex<Health>>,
    /// Held by whoever may still write.
    _lock: Option<Arc<Lock>>,
}

impl Default for Disk {
    fn default() -> Self {
        Self::new(Arc::new(FileSystem))
    }
}

impl Disk {
    /// By this storage and the system's clock, without a lock.
    pub fn new(storage: Arc<dyn Storage>) -> Self {
        Self {
            storage,
            clock: ServiceClock::start(),
            health: Arc::default(),
            _lock: None,
        }
    }

    /// By this storage, for the only service of a folder, which is made where needed.
    ///
    /// # Errors
    /// [`FolderError`] where another service has it, or it cannot be made.
    pub fn of(folder: &Path, storage: Arc<dyn Storage>) -> Result<Self, FolderError> {
        fs::create_dir_all(folder).map_err(|error| FolderError::System {
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

    /// The same by another clock, which says since when something fails.
    pub fn on_clock(self, clock: ServiceClock) -> Self {
        Self { clock, ..self }
    }

    /// The operations themselves.
    pub fn storage(&self) -> &dyn Storage {
        &*self.storage
    }

    /// Writes a file: whoever reads it finds what was there before or this, whole, whatever happens.
    ///
    /// # Errors
    /// The system's error. What was there before is still there then.
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
            // It would only take room; where it cannot be removed either, the next attempt replaces it.
            let _ = self.storage.remove(&beside);
            return Err(error);
        }
        match path.parent() {
            // The new name is on the medium only once its folder is.
            Some(folder) if !folder.as_os_str().is_empty() => self.storage.sync(folder),
            _ => self.storage.sync(Path::new(".")),
        }
    }

    /// Remembers how an attempt to write went, and passes its result on.
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

    /// Counts a recording that is not whole on the shelf.
    pub fn lost_recording(&self) {
        self.health().lost_recording();
    }

    /// Whether something could not be written the last time.
    pub fn is_failing(&self, what: DiskPart) -> bool {
        self.health().is_failing(what)
    }

    /// Why something could not be written, as long as that is so.
    pub fn fault(&self, what: DiskPart) -> Option<String> {
        let view = self.health().view();
        let fault = view.faults.into_iter().find(|fault| fault.what == what);
        fault.map(|fault| fault.reason)
    }

    /// For the outside.
    pub fn view(&self) -> DiskView {
        self.health().view()
    }

    fn health(&self) -> MutexGuard<'_, Health> {
        // Counts and texts are right even if somebody panicked beside them.
        self.health.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Where a file is written before it takes its name.
pub fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".new");
    path.with_file_name(name)
}

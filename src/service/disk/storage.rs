//! The write operations on the data folder, and the file system that implements them.

use std::fmt::Debug;
use std::fs::{self, File};
use std::io;
use std::path::Path;

use rustix::fs::{Access, access, statvfs};

use crate::recording::Sink;

/// The disk operations that the service needs. Reading does not use it: a full disk can still be read.
///
/// An implementation for a test may refuse any call, or lose unsynced data.
pub trait Storage: Debug + Send + Sync {
    /// Creates an empty file, replacing an old one, and returns its writer.
    ///
    /// # Errors
    /// The system's error.
    fn create(&self, path: &Path) -> io::Result<Sink>;

    /// Creates a folder within an existing one. It is no error if the folder exists.
    ///
    /// # Errors
    /// The system's error.
    fn create_folder(&self, path: &Path) -> io::Result<()>;

    /// Waits until a file's bytes, or a folder's entries, are durable.
    ///
    /// # Errors
    /// The system's error.
    fn sync(&self, path: &Path) -> io::Result<()>;

    /// Renames a file or folder; an existing file of that name is replaced atomically.
    ///
    /// # Errors
    /// The system's error.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;

    /// Removes a file, or a folder with all that is in it.
    ///
    /// # Errors
    /// The system's error.
    fn remove(&self, path: &Path) -> io::Result<()>;

    /// Looks, without a write, whether a folder is there and may take new files of `room` bytes. A medium
    /// may refuse a write all the same, as by a quota.
    ///
    /// # Errors
    /// What is the matter with the folder.
    fn look(&self, folder: &Path, room: u64) -> io::Result<()>;
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct FileSystem;

impl Storage for FileSystem {
    fn create(&self, path: &Path) -> io::Result<Sink> {
        Ok(Box::new(File::create(path)?))
    }

    fn create_folder(&self, path: &Path) -> io::Result<()> {
        match fs::create_dir(path) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && path.is_dir() => Ok(()),
            result => result,
        }
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        File::open(path)?.sync_all()
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        match path.is_dir() {
            true => fs::remove_dir_all(path),
            false => fs::remove_file(path),
        }
    }

    fn look(&self, folder: &Path, room: u64) -> io::Result<()> {
        let is_folder = fs::metadata(folder).map(|data| data.is_dir());
        match is_folder {
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err(io::Error::new(error.kind(), "the folder is gone"));
            }
            Ok(false) => return Err(not_a_folder()),
            other => other?,
        };
        access(folder, Access::WRITE_OK | Access::EXEC_OK)?;
        let disk = statvfs(folder)?;
        let free = disk.f_bavail.saturating_mul(disk.f_frsize);
        // Where a file system does not know its size, it says 0.
        if disk.f_blocks > 0 && free < room {
            let words = format!("the disk is full: {free} bytes are free");
            return Err(io::Error::new(io::ErrorKind::StorageFull, words));
        }
        Ok(())
    }
}

/// Creates a folder with those above it, unless it is there.
///
/// # Errors
/// The system's error, or that a file has its name.
pub fn make_folder(path: &Path) -> io::Result<()> {
    fs::create_dir_all(path).map_err(|error| match path.is_file() {
        true => not_a_folder(),
        false => error,
    })
}

fn not_a_folder() -> io::Error {
    let words = "it is a file, and a folder is needed";
    io::Error::new(io::ErrorKind::NotADirectory, words)
}

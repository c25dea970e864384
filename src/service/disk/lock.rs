//! The lock on the data folder: one service for each folder.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use thiserror::Error;

/// The locked file. It remains after the service has ended; only the lock counts.
const FILE: &str = "quell.lock";
/// Most bytes that are read of it: a pid and a date take 50.
const LONGEST: u64 = 200;

/// Why a data folder cannot be used.
#[derive(Debug, Error)]
pub enum FolderError {
    /// Another service uses it.
    #[error(
        "the data folder {} is in use by {holder}: one service writes to a folder; \
         end that one, or give this one another folder (--data, service.data)",
        folder.display()
    )]
    Taken {
        /// The folder.
        folder: PathBuf,
        /// Process and start time, as the lock file has them.
        holder: String,
    },
    /// It cannot be created, or the lock is not available.
    #[error("the data folder: {}: {error}", path.display())]
    System {
        /// The folder or the lock file.
        path: PathBuf,
        /// The system's error.
        error: io::Error,
    },
}

/// The lock, held until this is dropped or the process ends in any way: it belongs to the open file, which the
/// system closes.
///
/// It is released explicitly when it is dropped. A child process that is about to be started holds a copy of
/// the open file for a moment, so that closing our copy alone would leave the folder locked for as long.
#[derive(Debug)]
pub struct Lock {
    file: File,
}

impl Lock {
    /// Takes the lock on a folder; `since` (seconds since 1970) is written as its start time.
    ///
    /// # Errors
    /// [`FolderError::Taken`] where another service holds it.
    pub fn take(folder: &Path, since: f64) -> Result<Self, FolderError> {
        let path = folder.join(FILE);
        let system = |error| FolderError::System {
            path: path.clone(),
            error,
        };
        let mut options = OpenOptions::new();
        let opened = options.read(true).write(true).create(true).truncate(false);
        let mut file = opened.open(&path).map_err(system)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(FolderError::Taken {
                    folder: folder.into(),
                    holder: holder(&mut file),
                });
            }
            Err(TryLockError::Error(error)) => return Err(system(error)),
        }
        if let Err(error) = sign(&mut file, since) {
            // The lock is held all the same; only its holder cannot be shown.
            tracing::warn!(%error, "{}", path.display());
        }
        Ok(Self { file })
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        if let Err(error) = self.file.unlock() {
            tracing::warn!(%error, "the lock of the data folder");
        }
    }
}

fn sign(file: &mut File, since: f64) -> io::Result<()> {
    file.set_len(0)?;
    let (pid, since) = (std::process::id(), utc(since));
    writeln!(file, "process {pid}, since {since}")
}

/// The holder of the lock, if the file names it.
fn holder(file: &mut File) -> String {
    let mut text = String::new();
    let read = file.take(LONGEST).read_to_string(&mut text);
    match (read, text.trim()) {
        (Ok(_), signed) if !signed.is_empty() => signed.into(),
        _ => "another process".into(),
    }
}

/// Seconds since 1970 as a date and a time of day.
///
/// Source: H. Hinnant, "chrono-compatible low-level date algorithms", `civil_from_days`.
fn utc(unix_time: f64) -> String {
    let seconds = unix_time.max(0.0) as u64;
    let (days, second) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let march = (5 * day + 2) / 153;
    let day = day - (153 * march + 2) / 5 + 1;
    let month = if march < 10 { march + 3 } else { march - 9 };
    let year = year + 400 * era + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

#[cfg(test)]
mod tests {
    use super::utc;

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(utc(0.0), "1970-01-01 00:00:00 UTC");
        assert_eq!(utc(951_827_696.5), "2000-02-29 12:34:56 UTC");
        assert_eq!(utc(1_798_761_599.0), "2026-12-31 23:59:59 UTC");
    }
}

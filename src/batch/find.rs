//! Recordings in folders of recordings.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::BatchError;
use crate::recording::{MANIFEST, McapFile, Problem};

/// Folders within folders that are looked into; deeper lies no archive of recordings, but a mistake.
const DEPTH: usize = 16;

/// The recordings that a path stands for, in the order of their names.
///
/// A file, or a folder with a `recording.toml`, is one; any other folder stands for the recordings below it:
/// folders with a `recording.toml`, and MCAP files. Links to folders are not followed.
///
/// # Errors
/// [`BatchError`] with the path where a folder cannot be read, or has no recording below it.
pub fn find(path: &Path) -> Result<Vec<PathBuf>, BatchError> {
    if !path.is_dir() || path.join(MANIFEST).is_file() {
        return Ok(vec![path.into()]);
    }
    let mut found = Vec::new();
    below(path, DEPTH, &mut found)?;
    match found.is_empty() {
        true => Err(Problem::NoManifest.in_file(path).into()),
        false => Ok(found),
    }
}

fn below(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) -> Result<(), BatchError> {
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder).map_err(BatchError::disk(folder))? {
        let entry = entry.map_err(BatchError::disk(folder))?;
        let kind = entry.file_type().map_err(BatchError::disk(entry.path()))?;
        entries.push((entry.path(), kind.is_dir()));
    }
    entries.sort();
    for (path, is_folder) in entries {
        if !is_folder {
            if McapFile::is_named(&path) {
                found.push(path);
            }
        } else if path.join(MANIFEST).is_file() {
            found.push(path);
        } else if depth > 0 {
            below(&path, depth - 1, found)?;
        }
    }
    Ok(())
}

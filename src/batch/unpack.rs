//! A packed recording back on disk, and nothing beside it.

use std::fs;
use std::path::{Component, Path, PathBuf};

use super::error::BatchError;
use super::pack::{names, plain};
use crate::recording::McapFile;

/// Writes the files of a packed recording into a folder, and returns what is to be read.
///
/// A path from elsewhere may not lead out of the folder: neither a name in the archive, nor the entry,
/// nor a file that the manifest names.
///
/// # Errors
/// [`BatchError::Archive`] where something is no regular file inside the folder, [`BatchError::Disk`] where
/// it cannot be written.
pub fn unpack(bytes: &[u8], entry: &str, folder: &Path) -> Result<PathBuf, BatchError> {
    let refused = |error: std::io::Error| BatchError::Archive(error.to_string());
    let mut archive = tar::Archive::new(bytes);
    for file in archive.entries().map_err(refused)? {
        let mut file = file.map_err(refused)?;
        let name = file.path().map_err(refused)?.into_owned();
        if !file.header().entry_type().is_file() || !stays(&name) {
            return Err(outside(&name));
        }
        let path = folder.join(&name);
        let parent = path.parent().unwrap_or(folder);
        fs::create_dir_all(parent).map_err(BatchError::disk(parent))?;
        let mut written = fs::File::create(&path).map_err(BatchError::disk(&path))?;
        std::io::copy(&mut file, &mut written).map_err(BatchError::disk(&path))?;
    }
    if !stays(Path::new(entry)) {
        return Err(outside(Path::new(entry)));
    }
    let path = folder.join(entry);
    if path.is_file() && !McapFile::is_named(&path) {
        let manifest = fs::read(&path).map_err(BatchError::disk(&path))?;
        let parent = path.parent().unwrap_or(folder);
        for name in names(&String::from_utf8_lossy(&manifest)) {
            if !plain(&parent.join(&name)).starts_with(folder) {
                return Err(outside(&name));
            }
        }
    }
    Ok(path)
}

/// Whether a name leads down only.
fn stays(name: &Path) -> bool {
    name.components()
        .all(|part| matches!(part, Component::Normal(_)))
}

fn outside(name: &Path) -> BatchError {
    BatchError::Archive(format!("{} is no file inside it", name.display()))
}

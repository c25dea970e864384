//! A recording as one piece: an archive of its manifest and the files that this names.
//!
//! Workers on other machines have no path to the files, so that the files go with the job. The archive is a
//! tar of regular files, in the order of their names and without owner or date: the same content gives the
//! same bytes, and so the same hash.

use std::fs;
use std::path::{Component, Path, PathBuf};

use super::error::BatchError;
use super::packed::Packed;
use crate::recording::{MANIFEST, McapFile, Problem, mcap_and_joint};

/// The most that the files of a recording may have, bytes: several hours of a few channels at 1 kHz, gzipped.
/// A worker holds them in memory while it opens them.
pub const MOST_BYTES: u64 = 256 << 20;

/// Packs a recording: a manifest, a folder with one, or an MCAP file (with `#joint` where it has several).
///
/// A fault inside of it does no harm here: it is told by who opens it.
///
/// # Errors
/// [`BatchError`] with the path where there is no such recording, it is above [`MOST_BYTES`], names a file
/// by an absolute path, or cannot be read.
pub fn pack(path: &Path) -> Result<Packed, BatchError> {
    let (file, joint) = mcap_and_joint(path);
    let file = if file.is_dir() {
        file.join(MANIFEST)
    } else {
        file
    };
    if !file.is_file() {
        let problem = match path.is_dir() {
            true => Problem::NoManifest,
            false => Problem::Missing,
        };
        return Err(problem.in_file(path).into());
    }
    let mut files = vec![file.clone()];
    if !McapFile::is_named(&file) {
        files.extend(beside(&file)?);
    }
    let mut named = Vec::new();
    for file in files {
        named.push((plain(&absolute(&file)?), file));
    }
    bounded(path, &named)?;
    let folders = named.iter().filter_map(|(plain, _)| plain.parent());
    let root = folders.map(Path::to_path_buf).reduce(common);
    let root = root.unwrap_or_default();
    let inside = |plain: &Path| plain.strip_prefix(&root).unwrap_or(plain).to_path_buf();
    let entry = inside(&named[0].0).to_string_lossy().into_owned();
    named.sort();
    named.dedup_by(|a, b| a.0 == b.0);
    let bytes = archive(&named, inside)?;
    let entry = match joint {
        Some(joint) => format!("{entry}#{joint}"),
        None => entry,
    };
    Ok(Packed::new(bytes, entry))
}

/// The files that a manifest names, as far as it can be read and they are there.
fn beside(manifest: &Path) -> Result<Vec<PathBuf>, BatchError> {
    let text = fs::read(manifest).map_err(BatchError::disk(manifest))?;
    let folder = manifest.parent().unwrap_or(Path::new(""));
    let mut files = Vec::new();
    for name in names(&String::from_utf8_lossy(&text)) {
        if name.is_absolute() {
            return Err(BatchError::Absolute {
                manifest: manifest.into(),
                file: name,
            });
        }
        files.push(folder.join(name));
    }
    files.retain(|file| file.is_file());
    Ok(files)
}

/// The files that a manifest names; nothing where it is none.
pub(super) fn names(manifest: &str) -> Vec<PathBuf> {
    let table: toml::Table = manifest.parse().unwrap_or_default();
    let channels = table.get("channel").and_then(|value| value.as_array());
    let files = channels.into_iter().flatten();
    files
        .filter_map(|channel| Some(PathBuf::from(channel.get("file")?.as_str()?)))
        .collect()
}

/// A path without `.`, and each `..` taken with what it undoes.
pub(super) fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                plain.pop();
            }
            part => plain.push(part),
        }
    }
    plain
}

fn absolute(path: &Path) -> Result<PathBuf, BatchError> {
    std::path::absolute(path).map_err(BatchError::disk(path))
}

/// The folder that two folders share.
fn common(a: PathBuf, b: PathBuf) -> PathBuf {
    let both = a.components().zip(b.components());
    both.take_while(|(a, b)| a == b).map(|(a, _)| a).collect()
}

fn bounded(path: &Path, files: &[(PathBuf, PathBuf)]) -> Result<(), BatchError> {
    let mut bytes = 0;
    for (_, file) in files {
        bytes += fs::metadata(file).map_err(BatchError::disk(file))?.len();
    }
    match bytes <= MOST_BYTES {
        true => Ok(()),
        false => Err(BatchError::TooLarge {
            path: path.into(),
            bytes,
            most: MOST_BYTES,
        }),
    }
}

fn archive(
    files: &[(PathBuf, PathBuf)],
    inside: impl Fn(&Path) -> PathBuf,
) -> Result<Vec<u8>, BatchError> {
    let mut archive = tar::Builder::new(Vec::new());
    for (plain, file) in files {
        let content = fs::read(file).map_err(BatchError::disk(file))?;
        let mut header = tar::Header::new_gnu();
        header.set_size(content.len() as u64);
        header.set_mode(0o644);
        header.set_entry_type(tar::EntryType::Regular);
        let added = archive.append_data(&mut header, inside(plain), content.as_slice());
        added.map_err(BatchError::disk(file))?;
    }
    let failed = |error: std::io::Error| BatchError::Archive(error.to_string());
    archive.into_inner().map_err(failed)
}

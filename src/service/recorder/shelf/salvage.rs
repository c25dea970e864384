//! Recordings left unfinished by a kill or by a full disk: stored on the shelf as far as they were written.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::about::{self, About};
use super::{DAMAGED, Draft, MCAP, Shelf, ShelfError, UNFINISHED, UNREADABLE, disk};
use crate::recording::{McapFile, Mended, Recording, RecordingError, Role};
use crate::service::disk::beside;

/// The content of an unfinished recording's folder.
enum Left {
    /// Nothing was measured yet.
    Nothing,
    /// A recording, with its file repaired.
    Recording(Box<Recording>, Mended),
    /// Something that cannot be read.
    Unreadable(RecordingError),
}

impl Shelf {
    /// Stores unfinished recordings on the shelf, except running ones. Their MCAP files are repaired, so that
    /// other programs can read them, too. Unreadable ones are set aside, not removed. `known` are the subjects of
    /// recordings whose end the disk has refused, by name: the file in the folder does not have the end. Returns the
    /// new entries of the shelf.
    ///
    /// # Errors
    /// [`ShelfError`] where the disk refuses; the rest stays as it is, for another attempt.
    pub fn salvage(
        &self,
        but: &[String],
        known: &[(String, About)],
    ) -> Result<Vec<(String, About)>, ShelfError> {
        let mut salvaged = Vec::new();
        for folder in self.hidden(UNFINISHED)? {
            let name = folder.file_name().unwrap_or_default().to_string_lossy();
            let name = name.trim_start_matches(UNFINISHED).to_owned();
            if but.contains(&name) {
                continue;
            }
            match left(&folder).map_err(|source| disk(&folder, source))? {
                Left::Nothing => {
                    tracing::info!(name, "nothing was recorded yet when the service ended");
                    self.remove(&folder)?;
                }
                Left::Recording(recording, mended) => {
                    let own = known.iter().rfind(|(known, _)| *known == name);
                    let about = own.map(|(_, about)| about.clone());
                    let about = about.unwrap_or_else(|| about::read(&folder).unwrap_or_default());
                    let kept = self.put_mended(&name, &folder, about, (*recording, &mended))?;
                    tracing::info!(name = kept.0, "kept as far as it came");
                    salvaged.push(kept);
                }
                Left::Unreadable(error) => self.set_aside(&name, &folder, &error)?,
            }
        }
        Ok(salvaged)
    }

    fn put_mended(
        &self,
        name: &str,
        folder: &Path,
        mut about: About,
        (mut recording, mended): (Recording, &Mended),
    ) -> Result<(String, About), ShelfError> {
        let command = recording.channel(Role::CommandPosition);
        let ends = command.and_then(|command| Some((command.time.first()?, command.time.last()?)));
        about.duration_s = ends.map_or(0.0, |(first, last)| last - first);
        recording.name = name.into();
        let original = folder.join(MCAP);
        let kept = self.put(name, &about, |draft: &Draft| {
            if mended.damage.is_some() {
                // Behind the damage there may be more data than this version can read.
                draft.copy(&original, DAMAGED)?;
            }
            draft.bytes(MCAP, &mended.bytes)?;
            draft.recording(&recording)
        })?;
        Ok((kept, about))
    }

    fn set_aside(
        &self,
        name: &str,
        folder: &Path,
        error: &RecordingError,
    ) -> Result<(), ShelfError> {
        let aside = self.free(&format!("{UNREADABLE}{name}"));
        let renamed = self.disk.storage().rename(folder, &aside);
        renamed.map_err(|source| disk(folder, source))?;
        let aside = aside.display();
        tracing::warn!(%error, "an unfinished recording cannot be read; it is kept as {aside}");
        Ok(())
    }
}

/// Reads the content of a folder.
fn left(folder: &Path) -> io::Result<Left> {
    let Some(file) = journal(folder) else {
        return Ok(Left::Nothing);
    };
    let mended = match McapFile::mended(&file) {
        Ok(mended) => mended,
        Err(error) => return Ok(Left::Unreadable(error)),
    };
    if mended.messages == 0 && mended.damage.is_none() {
        return Ok(Left::Nothing);
    }
    let recording = McapFile::of(&file, mended.bytes.clone()).and_then(|file| file.recording(None));
    Ok(match recording {
        Ok(recording) => Left::Recording(Box::new(recording), mended),
        Err(error) => Left::Unreadable(error),
    })
}

/// The file that has grown with the recording. If the service was killed at its start, it does not have its
/// name yet.
/// its name yet.
fn journal(folder: &Path) -> Option<PathBuf> {
    let file = folder.join(MCAP);
    let has_bytes = |path: &PathBuf| fs::metadata(path).is_ok_and(|data| data.len() > 0);
    [file.clone(), beside(&file)].into_iter().find(has_bytes)
}

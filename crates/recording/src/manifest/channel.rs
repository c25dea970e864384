//! One channel of a manifest: its cells or messages, without those that are missing, in SI.

use super::{Entry, Files, Manifest, Source, key, start};
use crate::Channel;
use crate::error::{Problem, RecordingError};
use crate::mcap::McapFile;
use crate::wraps::unwrap;
use std::path::{Path, PathBuf};

impl Source<'_> {
    /// The channel of an entry.
    pub(super) fn channel(
        &self,
        entry: &Entry,
        manifest: &Manifest,
        files: &mut Files,
    ) -> Result<Channel, RecordingError> {
        let role = self.role(&entry.role)?;
        let unit = self.unit(&entry.unit)?;
        let scale = self.finite("scale", &entry.scale)?;
        let offset = self.finite("offset", &entry.offset)?;
        if scale == Some(0.0) {
            return Err(self.at(start(&entry.scale), key("scale", "it is 0")));
        }
        let wrap = self.positive("wrap", &entry.wrap)?;
        let path = self.file(entry)?;
        let rows = entry.rows.as_ref().or(manifest.rows.as_ref());
        let (mut time, mut columns) = match McapFile::is_named(&path) {
            true => self.messages(entry, role, path, files)?,
            false => {
                let layout = entry.csv.as_ref().or(manifest.csv.as_ref());
                let rows = rows.map_or(0..usize::MAX, |rows| rows.get_ref()[0]..rows.get_ref()[1]);
                self.cells((entry, layout, rows), role, path, files)?
            }
        };
        if let Some(rows) = rows {
            let [first, last] = self.rows(rows, time.len())?;
            for values in columns.iter_mut().chain([&mut time]) {
                values.truncate(last);
                values.drain(..first);
            }
        }
        without_missing(&mut time, &mut columns);
        if time.is_empty() {
            return Err(Problem::NoRows.in_file(self.path));
        }
        if let Some(period) = wrap {
            columns.iter_mut().for_each(|own| unwrap(own, period));
        }
        for value in columns.iter_mut().flatten() {
            *value = unit.to_si(*value * scale.unwrap_or(1.0) + offset.unwrap_or(0.0));
            if !value.is_finite() {
                return Err(self.at(start(&entry.scale), key("scale", "the values overflow")));
            }
        }
        Ok(Channel {
            role,
            unit: unit.si.into(),
            time,
            columns,
        })
    }

    /// The entry's file, if it exists.
    fn file(&self, entry: &Entry) -> Result<PathBuf, RecordingError> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let path = folder.join(entry.file.get_ref());
        let reason = match (path.exists(), path.is_dir()) {
            (true, false) => return Ok(path),
            (true, true) => format!("{} is a folder", path.display()),
            (false, _) => format!("there is no file {}", path.display()),
        };
        Err(self.at(entry.file.span().start, key("file", reason)))
    }
}

/// Drops rows with a missing stamp or value.
fn without_missing(time: &mut Vec<f64>, columns: &mut [Vec<f64>]) {
    let is_there = |row: usize| !(time[row].is_nan() || columns.iter().any(|c| c[row].is_nan()));
    let kept: Vec<bool> = (0..time.len()).map(is_there).collect();
    if kept.iter().all(|kept| *kept) {
        return;
    }
    for values in columns.iter_mut().chain([time]) {
        let mut row = 0;
        values.retain(|_| {
            row += 1;
            kept[row - 1]
        });
    }
}

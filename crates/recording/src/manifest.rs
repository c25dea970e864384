//! The manifest of a recording: a TOML file that says what the columns of CSV files are, or the topics of an
//! MCAP file.

mod csv;
mod topic;

use super::error::{Problem, RecordingError, from_io, nearest};
use super::mcap::McapFile;
use super::role::{ROLES, Role};
use super::table::Table;
use super::unit::{UNITS, Unit};
use super::{Channel, MANIFEST, Recording};
use serde::Deserialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// The keys of a manifest and of its channels, for suggestions.
const KEYS: &[&str] = &[
    "name", "payload", "rows", "channel", "role", "file", "time", "rate_hz", "column", "columns",
    "topic", "field", "fields", "unit", "scale", "offset",
];

/// The whole file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Manifest {
    /// Name of the recording.
    name: String,
    /// What the arm carries, as `2 kg`; recordings of one axis may differ in it.
    payload: Option<String>,
    /// Only these rows below the header, `[first, last)`, counted from 0; they keep their stamps.
    rows: Option<Rows>,
    /// The channels.
    channel: Vec<Entry>,
}

/// `[first, last)`: rows below the header, counted from 0.
type Rows = Spanned<[usize; 2]>;

/// `[[channel]]`: one measured quantity.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    /// What is measured, a name of the [table of roles](#roles).
    role: Spanned<String>,
    /// File beside the manifest: `.csv`, `.csv.gz` or `.mcap`.
    file: Spanned<PathBuf>,
    /// Column with the stamps, s. Of an MCAP file `log_time`, `publish_time` or a field; `header.stamp` where absent.
    time: Option<Spanned<String>>,
    /// Samples a second, Hz, instead of `time`; CSV only.
    rate_hz: Option<Spanned<f64>>,
    /// Column of the values.
    column: Option<String>,
    /// Columns of a vector, instead of `column`.
    columns: Option<Vec<String>>,
    /// Topic of an MCAP file.
    topic: Option<Spanned<String>>,
    /// Field of its messages, as `position[0]`, or `position[shoulder]` by the name beside it.
    field: Option<String>,
    /// Fields of a vector, instead of `field`.
    fields: Option<Vec<String>>,
    /// Unit of the values, a name of the [table of units](#units).
    unit: Spanned<String>,
    /// Rows of this channel, instead of the recording's.
    rows: Option<Rows>,
    /// Factor: the value is `cell * scale + offset`, in `unit`; 1 where absent.
    scale: Option<Spanned<f64>>,
    /// Offset, in `unit`; 0 where absent.
    offset: Option<Spanned<f64>>,
}

/// The files that a manifest names, each read once.
#[derive(Default)]
struct Files {
    tables: HashMap<PathBuf, Table>,
    mcap: HashMap<PathBuf, McapFile>,
}

/// Stamps and columns as they stand in a file.
type Numbers = (Vec<f64>, Vec<Vec<f64>>);

/// Reads the recording that a manifest (or the folder of a `recording.toml`) describes.
pub(super) fn read(path: &Path) -> Result<Recording, RecordingError> {
    let path = locate(path)?;
    let text = std::fs::read_to_string(&path).map_err(|error| match error.kind() {
        std::io::ErrorKind::InvalidData => Problem::NotUtf8.in_file(&path),
        _ => from_io(&error).in_file(&path),
    })?;
    let source = Source {
        path: &path,
        text: &text,
    };
    let manifest: Manifest = toml::from_str(&text).map_err(|error| source.syntax(&error))?;
    if manifest.channel.is_empty() {
        return Err(key("channel", "there is none").in_file(&path));
    }
    let mut files = Files::default();
    let channels = manifest
        .channel
        .iter()
        .map(|entry| source.channel(entry, manifest.rows.as_ref(), &mut files));
    Ok(Recording {
        name: manifest.name,
        payload: manifest.payload,
        channels: channels.collect::<Result<_, _>>()?,
    })
}

fn locate(path: &Path) -> Result<PathBuf, RecordingError> {
    if path.is_dir() {
        let manifest = path.join(MANIFEST);
        return if manifest.is_file() {
            Ok(manifest)
        } else {
            Err(Problem::NoManifest.in_file(path))
        };
    }
    let extension = path.extension().and_then(|extension| extension.to_str());
    match extension {
        _ if !path.exists() => Err(Problem::Missing.in_file(path)),
        Some("csv" | "gz") => Err(Problem::NotAManifest.in_file(path)),
        _ => Ok(path.into()),
    }
}

fn key(key: &'static str, reason: impl Into<String>) -> Problem {
    Problem::Key {
        key,
        reason: reason.into(),
    }
}

/// A manifest's path and text, to tell the line of what is wrong in it.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Source<'_> {
    fn at(&self, offset: usize, problem: Problem) -> RecordingError {
        let before = &self.text.as_bytes()[..offset.min(self.text.len())];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        problem.at_line(self.path, line)
    }

    fn syntax(&self, error: &toml::de::Error) -> RecordingError {
        let Some(span) = error.span() else {
            return Problem::Toml(error.message().into()).in_file(self.path);
        };
        let text = self
            .text
            .get(span.clone())
            .unwrap_or_default()
            .trim_matches(['"', '\'']);
        let problem = if error.message().starts_with("unknown field") {
            Problem::UnknownKey {
                key: text.into(),
                nearest: nearest(text, KEYS.iter().copied()),
            }
        } else {
            Problem::Toml(error.message().trim().replace('\n', "; "))
        };
        self.at(span.start, problem)
    }

    fn channel(
        &self,
        entry: &Entry,
        rows: Option<&Rows>,
        files: &mut Files,
    ) -> Result<Channel, RecordingError> {
        let role = self.role(&entry.role)?;
        let unit = self.unit(&entry.unit)?;
        let scale = self.finite("scale", &entry.scale)?;
        let offset = self.finite("offset", &entry.offset)?;
        if scale == Some(0.0) {
            return Err(self.at(start(&entry.scale), key("scale", "it is 0")));
        }
        let path = self.file(entry)?;
        let (mut time, mut columns) = match McapFile::is_named(&path) {
            true => self.messages(entry, role, path, files)?,
            false => self.cells(entry, role, path, files)?,
        };
        if let Some(rows) = entry.rows.as_ref().or(rows) {
            let [first, last] = self.rows(rows, time.len())?;
            for values in columns.iter_mut().chain([&mut time]) {
                values.truncate(last);
                values.drain(..first);
            }
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

    fn role(&self, name: &Spanned<String>) -> Result<Role, RecordingError> {
        Role::from_name(name.get_ref()).ok_or_else(|| {
            let nearest = nearest(name.get_ref(), ROLES.iter().map(|entry| entry.name));
            let problem = Problem::UnknownRole {
                role: name.get_ref().clone(),
                nearest,
            };
            self.at(name.span().start, problem)
        })
    }

    fn unit(&self, name: &Spanned<String>) -> Result<&'static Unit, RecordingError> {
        Unit::from_name(name.get_ref()).ok_or_else(|| {
            let names = UNITS.iter().flat_map(|unit| unit.names.iter().copied());
            let nearest = nearest(name.get_ref(), names);
            let problem = Problem::UnknownUnit {
                unit: name.get_ref().clone(),
                nearest,
            };
            self.at(name.span().start, problem)
        })
    }

    fn finite(
        &self,
        name: &'static str,
        value: &Option<Spanned<f64>>,
    ) -> Result<Option<f64>, RecordingError> {
        match value.as_ref().map(|value| *value.get_ref()) {
            Some(number) if !number.is_finite() => Err(self.at(
                start(value),
                key(name, format!("{number} is not a finite number")),
            )),
            number => Ok(number),
        }
    }

    /// The range, where it lies in a file of so many rows.
    fn rows(&self, rows: &Rows, count: usize) -> Result<[usize; 2], RecordingError> {
        let [first, last] = *rows.get_ref();
        let reason = if first >= last {
            format!("from row {first} up to before row {last} there is no row")
        } else if last > count {
            format!("the file has {count} rows, so it ends before row {last}")
        } else {
            return Ok([first, last]);
        };
        Err(self.at(rows.span().start, key("rows", reason)))
    }

    /// The names of a channel's columns or fields, under the one key or the other.
    fn names<'e>(
        &self,
        entry: &'e Entry,
        role: Role,
        [one, many]: [&'static str; 2],
        names: (&'e Option<String>, &'e Option<Vec<String>>),
    ) -> Result<Vec<&'e str>, RecordingError> {
        let names: Vec<&str> = match names {
            (Some(name), None) => vec![name],
            (None, Some(names)) => names.iter().map(String::as_str).collect(),
            _ => {
                let reason = format!("give either {one} = \"...\" or {many} = [...]");
                return Err(self.at(entry.role.span().start, key(one, reason)));
            }
        };
        let allowed = role.entry().columns;
        if allowed.contains(&names.len()) {
            return Ok(names);
        }
        let allowed: Vec<String> = allowed.iter().map(usize::to_string).collect();
        let reason = format!(
            "{role} takes {} {one}(s), not {}",
            allowed.join(" or "),
            names.len()
        );
        Err(self.at(entry.role.span().start, key(many, reason)))
    }

    /// The entry's file, which is there.
    fn file(&self, entry: &Entry) -> Result<PathBuf, RecordingError> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let path = folder.join(entry.file.get_ref());
        if path.exists() {
            return Ok(path);
        }
        let reason = format!("there is no file {}", path.display());
        Err(self.at(entry.file.span().start, key("file", reason)))
    }
}

fn start<T>(value: &Option<Spanned<T>>) -> usize {
    value.as_ref().map_or(0, |value| value.span().start)
}

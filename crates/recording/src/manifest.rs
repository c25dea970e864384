//! The manifest of a recording: a TOML file that says what the columns of CSV and Parquet files are, or the topics
//! of an MCAP file.

mod channel;
mod csv;
mod topic;
mod unknown;
mod values;

use super::error::{Problem, RecordingError, from_io};
use super::layout::Layout;
use super::mcap::McapFile;
use super::stamp::Origin;
use super::syntax::SyntaxError;
use super::table::Table;
use super::{MANIFEST, Recording, Role, foreign, propose};
use serde::Deserialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// The head of a channel.
const BLOCK: &str = "[[channel]]";
/// What the reader says where there is none.
const NO_CHANNEL: &str = "missing field `channel`";

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
    /// How its CSV files are written, where they are not plain.
    csv: Option<Layout>,
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
    /// Whose channel it is, where a recording has several joints: its name in the robot's description. Without it a channel
    /// is every joint's.
    joint: Option<Spanned<String>>,
    /// File beside the manifest: `.csv`, `.csv.gz`, `.parquet` (feature `parquet`) or `.mcap`.
    file: Spanned<PathBuf>,
    /// Column with the stamps, s. Of an MCAP file `log_time`, `publish_time` or a field; `header.stamp` where absent.
    time: Option<Spanned<String>>,
    /// Unit of the stamps: `s`, `ms`, `us`, `ns`, `min`, `day` for serial dates of spreadsheets; `iso` for dates of ISO 8601
    /// and times of day as `12:01:02.5`, `dmy` for `03.05.2024 12:01:02,5` and `03/05/2024 12:01:02`, `mdy` for
    /// `05/03/2024 12:01:02 PM`, or `iec` for durations of controllers as `T#1s4ms`; `s` where absent. With this key stamps since an epoch are told from the first one's whole
    /// second on, and a time of day goes on over midnight. Not for MCAP.
    time_unit: Option<Spanned<String>>,
    /// Period of the stamps in their own unit, as 4294967296 of microseconds in 32 bits: their counter begins again there, and they go on.
    /// For stamps that are numbers; not for MCAP.
    time_wrap: Option<Spanned<f64>>,
    /// Samples a second, Hz, instead of `time`; not for MCAP.
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
    /// How this channel's file is written, instead of the recording's `csv`.
    csv: Option<Layout>,
    /// Factor: the value is `cell * scale + offset`, in `unit`; 1 where absent.
    scale: Option<Spanned<f64>>,
    /// Offset, in `unit`; 0 where absent.
    offset: Option<Spanned<f64>>,
    /// Period of the cells, as 65536: a counter begins again there, and its jumps are taken out. Neighbours must be less than
    /// half of it apart.
    wrap: Option<Spanned<f64>>,
}

/// The files of a manifest, each read once.
#[derive(Default)]
struct Files {
    tables: HashMap<PathBuf, (Layout, Table)>,
    mcap: HashMap<PathBuf, McapFile>,
    /// Origin of stamps since an epoch.
    origin: Origin,
}

/// Stamps and columns as in a file.
type Numbers = (Vec<f64>, Vec<Vec<f64>>);

/// Reads the recording that a manifest (or the folder of a `recording.toml`) describes; of several joints the
/// named one.
pub(super) fn read(path: &Path, joint: Option<&str>) -> Result<Recording, RecordingError> {
    let path = locate(path)?;
    read_joint(&path, &text(&path)?, joint)
}

/// The names of the columns of a role's vector; `None` where it cannot be read, or has no such vector.
pub(super) fn columns(path: &Path, role: Role) -> Option<Vec<String>> {
    let path = &locate(path).ok()?;
    let text = &text(path).ok()?;
    let manifest = Source { path, text }.manifest().ok()?;
    let is_own = |entry: &&Entry| entry.role.get_ref() == role.name();
    manifest.channel.iter().find(is_own)?.columns.clone()
}

/// Reads the recordings of all joints in a manifest.
pub(super) fn read_joints(path: &Path) -> Result<Vec<(String, Recording)>, RecordingError> {
    let path = locate(path)?;
    let text = text(&path)?;
    let source = Source {
        path: &path,
        text: &text,
    };
    let (manifest, mut files) = (source.manifest()?, Files::default());
    let of = |joint: String| {
        let recording = source.recording(&manifest, Some(&joint), &mut files)?;
        Ok((joint, recording))
    };
    manifest.joints().into_iter().map(of).collect()
}

/// The text of a manifest, or of the one proposed for an unambiguous CSV file.
fn text(path: &Path) -> Result<String, RecordingError> {
    let is_manifest = path.extension().is_some_and(|ending| ending == "toml");
    if propose::is_csv(path) || !(is_manifest || path.is_dir()) {
        return propose::certain(path);
    }
    std::fs::read_to_string(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::InvalidData => Problem::NotUtf8.in_file(path),
        _ => from_io(&error).in_file(path),
    })
}

/// The recording described by the text of a manifest, with files relative to `path`.
fn read_joint(path: &Path, text: &str, joint: Option<&str>) -> Result<Recording, RecordingError> {
    let source = Source { path, text };
    let (manifest, mut files) = (source.manifest()?, Files::default());
    let joints = manifest.joints();
    let known = |name: &str| joints.iter().any(|joint| joint == name);
    let reason = match joint {
        Some(name) if !known(name) => format!("no channel names \"{name}\""),
        None if joints.len() > 1 => format!(
            "there are {}: {}; take one as {}#{}, or all with quell diagnose --robot",
            joints.len(),
            joints.join(", "),
            path.display(),
            joints[0]
        ),
        _ => return source.recording(&manifest, joint, &mut files),
    };
    Err(key("joint", reason).in_file(path))
}

impl Manifest {
    /// The joints of its channels, in their order.
    fn joints(&self) -> Vec<String> {
        let named = self.channel.iter().filter_map(|entry| entry.joint.as_ref());
        propose::distinct(named.map(Spanned::get_ref))
    }
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
    if !path.exists() {
        return Err(Problem::Missing.in_file(path));
    }
    match foreign::by_ending(path) {
        Some(format) => Err(Problem::Foreign(format).in_file(path)),
        None => Ok(path.into()),
    }
}

fn key(key: &'static str, reason: impl Into<String>) -> Problem {
    Problem::Key {
        key,
        reason: reason.into(),
    }
}

/// A manifest's path and text, to find the line of an error.
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
                advice: unknown::advice(text, error.message()),
            }
        } else {
            let told = SyntaxError::of(self.text, error);
            let mut error = self.at(span.start, Problem::Toml(told.reason));
            error.place.character = told.column;
            return error;
        };
        self.at(span.start, problem)
    }

    fn manifest(&self) -> Result<Manifest, RecordingError> {
        let read = |error: toml::de::Error| match error.message() {
            NO_CHANNEL => self.no_channel(),
            _ => self.syntax(&error),
        };
        let manifest: Manifest = toml::from_str(self.text).map_err(read)?;
        match manifest.channel.is_empty() {
            true => Err(self.no_channel()),
            false => Ok(manifest),
        }
    }

    /// That there is no channel, at the first block that is still a comment.
    fn no_channel(&self) -> RecordingError {
        let is_block = |line: &str| line.trim_start_matches(['#', ' ']).starts_with(BLOCK);
        match self.text.lines().position(is_block) {
            Some(line) => key(
                "channel",
                "there is none yet: fill in role and unit of this block, or of another one, and take the marks # of its lines away",
            )
            .at_line(self.path, line + 1),
            None => key("channel", format!("there is none: write a block {BLOCK}")).in_file(self.path),
        }
    }

    /// The recording of a joint; of all channels where none is named.
    fn recording(
        &self,
        manifest: &Manifest,
        joint: Option<&str>,
        files: &mut Files,
    ) -> Result<Recording, RecordingError> {
        let own = |entry: &&Entry| match (&entry.joint, joint) {
            (Some(own), Some(joint)) => own.get_ref() == joint,
            _ => true,
        };
        let channels = manifest.channel.iter().filter(own);
        self.each_role_once(channels.clone())?;
        let channels = channels.map(|entry| self.channel(entry, manifest, files));
        Ok(Recording {
            name: manifest.name.clone(),
            payload: manifest.payload.clone(),
            channels: channels.collect::<Result<_, _>>()?,
        })
    }
}

fn start<T>(value: &Option<Spanned<T>>) -> usize {
    value.as_ref().map_or(0, |value| value.span().start)
}

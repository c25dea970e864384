//! The description of a recording: the file beside its manifest, and its name.

use std::fs;
use std::io;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::service::contract::{ModeValue, MoveResult};

/// The file with the description of a recording, beside its manifest.
pub const ABOUT: &str = "about.json";
/// The longest name, bytes: file systems take 255, and prefixes and suffixes are added.
const LONGEST_NAME: usize = 128;

/// Why a recording ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RecordingEnd {
    /// It did not end: the service was killed, or the disk took no more. Or an earlier version made it.
    #[default]
    Cut,
    /// Its move has ended, for the reason in `result`.
    Move,
    /// Somebody has ended the recording on demand.
    Request,
    /// It was as long as a recording on demand may be.
    Longest,
    /// The service has ended.
    Service,
}

/// The subject of a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct About {
    /// Its number, one more than that of the recording before it, whatever the clock says. 0 for those
    /// of an earlier version, which had none.
    pub number: u64,
    /// The joint.
    pub joint: String,
    /// When it began, seconds since 1970.
    pub unix_time_s: f64,
    /// How long it is, s.
    pub duration_s: f64,
    /// Mode that was shaped for at its end.
    pub mode: Option<ModeValue>,
    /// Payload of the embedded arm, kg.
    pub payload_kg: Option<f64>,
    /// The result of the move, also where the disk took no more of it; absent where the recording was made on demand, or the service was killed.
    pub result: Option<MoveResult>,
    /// Why it ended.
    pub ended: RecordingEnd,
    /// Batches that were lost while it was made.
    pub batches_lost: u64,
}

/// A recording of the list.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Entry {
    /// Name.
    pub name: String,
    /// Bytes on disk.
    pub bytes: u64,
    /// Its subject.
    #[serde(flatten)]
    pub about: About,
}

impl Entry {
    /// The recording in a folder; `None` where there is none, or it is being removed.
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str().filter(|name| is_name(name))?;
        Some(Self {
            name: name.into(),
            bytes: bytes(path)?,
            about: read(path).ok()?,
        })
    }

    /// Whether it was made before another one, by their numbers. Recordings of an earlier version have none and
    /// come first, by their times, then by name.
    pub fn order(&self, other: &Self) -> std::cmp::Ordering {
        let of = |entry: &Self| (entry.about.number, entry.about.unix_time_s);
        let ((a, at), (b, bt)) = (of(self), of(other));
        a.cmp(&b)
            .then(at.total_cmp(&bt))
            .then_with(|| self.name.cmp(&other.name))
    }
}

/// Bytes of all files in a folder.
pub fn bytes(folder: &Path) -> Option<u64> {
    let files = fs::read_dir(folder).ok()?.flatten();
    Some(
        files
            .filter_map(|file| Some(file.metadata().ok()?.len()))
            .sum(),
    )
}

/// The description of the recording in a folder; empty where the file cannot be understood.
pub fn read(folder: &Path) -> io::Result<About> {
    let text = fs::read(folder.join(ABOUT))?;
    Ok(serde_json::from_slice(&text).unwrap_or_default())
}

/// A valid name from any text: invalid characters become `_`.
pub fn name_of(text: &str) -> String {
    let fit = |c: char| if is_letter(c) { c } else { '_' };
    let name: String = text.chars().map(fit).take(LONGEST_NAME - 16).collect();
    match is_name(&name) {
        true => name,
        false => format!("_{name}"),
    }
}

/// Whether a name is valid: letters, digits, `-`, `_`, and dots that are not first.
pub fn is_name(name: &str) -> bool {
    (1..=LONGEST_NAME).contains(&name.len())
        && name.chars().all(is_letter)
        && !name.starts_with('.')
}

fn is_letter(c: char) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.')
}

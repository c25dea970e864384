//! The joints of a recording, each with what is in its channels.

use super::document::document;
use super::{follows, page};
use crate::recording::health::{Health, health};
use crate::recording::{Recording, RecordingError};
use serde_json::{Value, json};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A recording with the figures of its channels: the only one of a manifest, or that of one of its joints.
struct Inspected {
    /// The joint, where the manifest has several.
    joint: Option<String>,
    recording: Recording,
    figures: Vec<Health>,
}

/// All joints of a manifest.
pub struct Joints {
    path: PathBuf,
    all: Vec<Inspected>,
}

impl Joints {
    /// Reads each joint of a manifest, its folder or a CSV file; of `folder#joint_2` the named one.
    ///
    /// # Errors
    /// As [`Recording::from_path`].
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let several = match path.exists() {
            true => Recording::joints(path)?,
            false => Vec::new(),
        };
        let all = match several.len() {
            0 | 1 => vec![Inspected::new(None, Recording::from_path(path)?)],
            _ => several
                .into_iter()
                .map(|(joint, recording)| Inspected::new(Some(joint), recording))
                .collect(),
        };
        let path = path.into();
        Ok(Self { path, all })
    }

    /// The tables and remarks of each joint.
    pub fn text(&self) -> String {
        let pages = self.all.iter().map(|one| {
            let page = page(&one.recording, &one.figures);
            let joint = one.joint.as_ref();
            joint.map_or(String::new(), |joint| format!("Joint {joint} of ")) + &page
        });
        pages.collect::<Vec<_>>().join("\n")
    }

    /// The same for `--json`.
    pub fn document(&self) -> Value {
        let one = |one: &Inspected| {
            let mut document = document(&one.recording, &one.figures);
            if let Some(joint) = &one.joint {
                document["joint"] = json!(joint);
            }
            document
        };
        match &*self.all {
            [only] => one(only),
            all => json!({"joints": all.iter().map(one).collect::<Vec<_>>()}),
        }
    }

    /// The next command, of several joints for the first.
    pub fn follows(&self) -> Vec<OsString> {
        let Some(first) = self.all.first() else {
            return Vec::new();
        };
        let mut path = self.path.clone().into_os_string();
        if let Some(joint) = &first.joint {
            path.push(format!("#{joint}"));
        }
        follows(&first.recording, Path::new(&path))
    }
}

impl Inspected {
    fn new(joint: Option<String>, recording: Recording) -> Self {
        let figures = recording.channels.iter().map(health).collect();
        Self {
            joint,
            recording,
            figures,
        }
    }
}

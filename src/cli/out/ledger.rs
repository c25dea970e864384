//! The list of the files in a folder with the verbs that wrote them: `.quell.json`.

use super::failed;
use crate::cli::CliError;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// Name of the list.
const NAME: &str = ".quell.json";

/// The files of a folder that Quell wrote.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Ledger {
    written: BTreeMap<String, Entry>,
}

/// One file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    verb: String,
    /// Hash of its content, in hexadecimal.
    sha256: String,
}

impl Ledger {
    /// The list of a folder; empty if the folder has none.
    ///
    /// # Errors
    /// [`CliError::Input`] where a file of that name is not such a list.
    pub fn read(folder: &Path) -> Result<Self, CliError> {
        let path = folder.join(NAME);
        let refused = |why: &dyn std::fmt::Display| {
            let text = format!("{}: not a list of what Quell wrote: {why}", path.display());
            CliError::input(text).with_help("give another folder, --out DIR, or remove that file")
        };
        match fs::read(&path) {
            Ok(bytes) => serde_json::from_slice(&bytes).map_err(|error| refused(&error)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Self::default()),
            Err(error) => Err(refused(&error)),
        }
    }

    /// The reason in words why a file with this content is not what the verb wrote; `None` if it is.
    pub fn stranger(&self, name: &Path, verb: &str, bytes: &[u8]) -> Option<String> {
        let Some(entry) = self.written.get(&key(name)) else {
            return Some("it is not known to be Quell's".into());
        };
        if entry.verb != verb {
            return Some(format!(
                "`quell {}` wrote it, not `quell {verb}`",
                entry.verb
            ));
        }
        (entry.sha256 != hash(bytes)).then(|| "it was changed since Quell wrote it".into())
    }

    /// Records a file.
    pub fn wrote(&mut self, name: &Path, verb: &str, bytes: &[u8]) {
        let entry = Entry {
            verb: verb.into(),
            sha256: hash(bytes),
        };
        self.written.insert(key(name), entry);
    }

    /// Writes the list into a folder atomically, through `stage` on the same disk.
    ///
    /// # Errors
    /// [`CliError::Failure`] where the disk refuses.
    pub fn write(&self, stage: &Path, folder: &Path) -> Result<(), CliError> {
        let (from, to) = (stage.join(NAME), folder.join(NAME));
        let mut text = serde_json::to_string_pretty(self).map_err(CliError::failure)?;
        text.push('\n');
        fs::write(&from, text).map_err(|error| failed(&to, error))?;
        fs::rename(&from, &to).map_err(|error| failed(&to, error))
    }
}

fn key(name: &Path) -> String {
    name.to_string_lossy().into_owned()
}

fn hash(bytes: &[u8]) -> String {
    format!("{:x}", Sha256::digest(bytes))
}

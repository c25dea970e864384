//! A job: a recording, and what is asked of it.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::packed::Packed;

/// The prefix of everything in the hash of a key: another meaning of the parts gets another number.
const MEANING: &str = "quell job 1";

/// A recording to be diagnosed, and by what model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Job {
    /// SHA-256 of what follows but the name, in hexadecimal: the same recording, model and options are the
    /// same job, wherever they lie and whatever their folder is called.
    pub key: String,
    /// Name of the recording's folder or file, for people.
    pub name: String,
    /// SHA-256 of the packed recording, in hexadecimal.
    pub recording: String,
    /// The entry to be read: the manifest, or the MCAP file with the joint.
    pub entry: String,
    /// The text of the model file.
    pub model: String,
    /// Seed of the bootstrap.
    pub seed: u64,
}

impl Job {
    /// A packed recording, under a name, with the text of a model and a seed.
    pub fn new(name: impl Into<String>, packed: &Packed, model: &str, seed: u64) -> Self {
        let mut job = Self {
            key: String::new(),
            name: name.into(),
            recording: packed.hash.clone(),
            entry: packed.entry.clone(),
            model: model.into(),
            seed,
        };
        job.key = job.computed();
        job
    }

    /// Whether the key is the hash of the parts.
    pub fn is_sound(&self) -> bool {
        self.key == self.computed()
    }

    fn computed(&self) -> String {
        let seed = self.seed.to_string();
        let parts = [MEANING, &self.recording, &self.entry, &self.model, &seed];
        let mut hash = Sha256::new();
        for part in parts {
            // With its length, so that no two lists of parts run into the same bytes.
            hash.update((part.len() as u64).to_be_bytes());
            hash.update(part);
        }
        format!("{:x}", hash.finalize())
    }
}

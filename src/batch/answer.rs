//! The outcome of a job.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::job::Job;

/// The head of an answer: its job, and whether it is a diagnosis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct About {
    /// Key of the job.
    pub key: String,
    /// Name of the recording's folder or file.
    pub name: String,
    /// SHA-256 of the packed recording.
    pub recording: String,
    /// Version of what answered.
    pub quell: String,
    /// How long it worked, s.
    pub seconds: f64,
    /// Why there is no diagnosis: the job was set aside.
    pub error: Option<String>,
}

/// The outcome of a job: a diagnosis and the better model, or an error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Answer {
    /// The job that it answers.
    #[serde(flatten)]
    pub about: About,
    /// The content of `diagnosis.json`, as the version that wrote it lays it out.
    pub diagnosis: Option<Value>,
    /// The content of `model.toml`, with the physics in it.
    pub model: Option<String>,
}

impl Answer {
    /// The job's diagnosis and model, or why there are none, after so many seconds.
    pub fn new(job: &Job, seconds: f64, outcome: Result<(Value, String), String>) -> Self {
        let (found, error) = match outcome {
            Ok(found) => (Some(found), None),
            Err(error) => (None, Some(error)),
        };
        let (diagnosis, model) = found.unzip();
        Self {
            about: About {
                key: job.key.clone(),
                name: job.name.clone(),
                recording: job.recording.clone(),
                quell: env!("CARGO_PKG_VERSION").into(),
                seconds,
                error,
            },
            diagnosis,
            model,
        }
    }

    /// A text of the diagnosis, such as its `verdict`.
    pub fn said(&self, key: &str) -> Option<&str> {
        self.diagnosis.as_ref()?.get(key)?.as_str()
    }
}

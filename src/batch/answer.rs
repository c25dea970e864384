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
    /// The report, a page; only where the diagnosis was made. It is a hundred times as large as the rest and does not travel.
    #[serde(skip)]
    pub report: Option<String>,
}

/// What a job makes.
#[derive(Clone, Debug)]
pub struct Done {
    /// The content of `diagnosis.json`.
    pub diagnosis: Value,
    /// The content of `model.toml`.
    pub model: String,
    /// The report.
    pub report: String,
}

impl Answer {
    /// What came of a job, or why nothing did, after so many seconds.
    pub fn new(job: &Job, seconds: f64, outcome: Result<Done, String>) -> Self {
        let (diagnosis, model, report, error) = match outcome {
            Ok(done) => (
                Some(done.diagnosis),
                Some(done.model),
                Some(done.report),
                None,
            ),
            Err(error) => (None, None, None, Some(error)),
        };
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
            report,
        }
    }

    /// A text of the diagnosis, such as its `verdict`.
    pub fn said(&self, key: &str) -> Option<&str> {
        self.diagnosis.as_ref()?.get(key)?.as_str()
    }
}

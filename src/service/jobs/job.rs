//! A job as the outside sees it.

use std::sync::Arc;
use std::time::Instant;

use schemars::JsonSchema;
use serde::Serialize;

use super::work::{Diagnosed, Failure};
use crate::diagnosis::Diagnosis;

/// Where a job stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Others are before it.
    Waiting,
    /// It is at work.
    Running,
    /// There is a verdict.
    Done,
    /// There is none: it could not be made, or not within its time.
    Failed,
    /// There is none: it was cancelled.
    Cancelled,
}

impl Status {
    /// Name in an answer.
    pub fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Running => "running",
            Self::Done => "done",
            Self::Failed => "failed",
            Self::Cancelled => "cancelled",
        }
    }

    /// Whether nothing more will come of it.
    pub fn has_ended(self) -> bool {
        !matches!(self, Self::Waiting | Self::Running)
    }
}

/// A job as the outside sees it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Job {
    /// Its number, counted up.
    pub id: u64,
    /// Name of the recording.
    pub recording: String,
    /// Where it stands.
    pub status: Status,
    /// The share of the work that is done, 0 to 1.
    pub progress: f64,
    /// The present step.
    pub doing: String,
    /// How long it has worked, s.
    pub seconds: f64,
    /// How long it may work, s; once it has begun.
    pub limit_s: Option<f64>,
    /// Why it failed.
    pub error: Option<String>,
    /// The diagnosis, once it is there.
    pub diagnosis: Option<Diagnosis>,
    #[serde(skip)]
    report: Option<Arc<str>>,
    #[serde(skip)]
    since: Option<Instant>,
}

impl Job {
    /// A waiting job.
    pub(super) fn new(id: u64, recording: String) -> Self {
        Self {
            id,
            recording,
            status: Status::Waiting,
            progress: 0.0,
            doing: "waiting".into(),
            seconds: 0.0,
            limit_s: None,
            error: None,
            diagnosis: None,
            report: None,
            since: None,
        }
    }

    /// Its present state.
    pub(super) fn now(&self) -> Self {
        let since = self.since.map(|since| since.elapsed().as_secs_f64());
        Self {
            seconds: since.unwrap_or(self.seconds),
            ..self.clone()
        }
    }

    /// The same without the diagnosis.
    pub(super) fn short(&self) -> Self {
        Self {
            diagnosis: None,
            report: None,
            ..self.now()
        }
    }

    pub(super) fn report(&self) -> Option<Arc<str>> {
        self.report.clone()
    }

    /// Marks it as running, for at most `limit` (s).
    pub(super) fn begin(&mut self, limit: f64) {
        (self.status, self.since) = (Status::Running, Some(Instant::now()));
        self.limit_s = Some(limit);
    }

    /// Marks it as cancelled.
    pub(super) fn cancel(&mut self) {
        self.close(Status::Cancelled);
    }

    /// Notes the outcome.
    pub(super) fn finish(&mut self, result: Result<Diagnosed, Failure>) {
        match result {
            Ok(done) => {
                self.close(Status::Done);
                self.progress = 1.0;
                self.report = Some(done.report.into());
                self.diagnosis = Some(done.diagnosis);
            }
            Err(Failure::Cancelled) => self.cancel(),
            Err(Failure::Told(error)) => {
                self.close(Status::Failed);
                self.error = Some(error);
            }
        }
    }

    fn close(&mut self, status: Status) {
        self.seconds = self.now().seconds;
        self.since = None;
        self.status = status;
        self.doing = status.name().into();
    }
}

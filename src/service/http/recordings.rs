//! Recordings: the list, and recording on demand.

use std::sync::Arc;

use axum::Json as Answer;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::App;
use super::answer::Refused;
use super::body::Json;
use super::commands::joint;
use super::views::fresh;
use crate::service::recorder::{Recorder, Shelf, ShelfError};

/// The body of a recording on demand.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// The joint; the first one where absent.
    joint: Option<String>,
    /// Whether to record from now on.
    recording: bool,
}

/// Which recording was begun or ended.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Recorded {
    /// Its name.
    name: String,
    /// Whether it was begun.
    recording: bool,
}

/// `GET /api/v1/recordings`, oldest first.
pub async fn list(State(app): State<Arc<App>>) -> Result<Response, Refused> {
    let list = match &app.settings.recorder {
        Some(recorder) => on_disk(recorder, Shelf::list).await?,
        None => Vec::new(),
    };
    Ok(fresh(&list))
}

/// `POST /api/v1/recordings`.
pub async fn record(
    State(app): State<Arc<App>>,
    Json(body): Json<Record>,
) -> Result<Answer<Recorded>, Refused> {
    let recorder = recorder(&app)?;
    let recording = body.recording;
    let name = if recording {
        let snapshot = app.handle.snapshot();
        let first = snapshot.joints.first().map(|joint| joint.name.clone());
        let wanted = body.joint.or(first).unwrap_or_default();
        let joint = joint(&snapshot, &wanted)?;
        let index = snapshot
            .joints
            .iter()
            .position(|one| one.name == joint.name);
        recorder
            .begin(&joint.name, index.unwrap_or_default())
            .await?
    } else {
        recorder.end().await?
    };
    Ok(Answer(Recorded { name, recording }))
}

/// The recorder.
///
/// # Errors
/// A sentence if recording is off.
pub fn recorder(app: &App) -> Result<&Recorder, Refused> {
    let sentence = "nothing is recorded: recording.enabled is false in the configuration";
    let refused = || Refused::new(StatusCode::NOT_FOUND, sentence);
    app.settings.recorder.as_ref().ok_or_else(refused)
}

/// Runs disk work on a thread that may block.
///
/// # Errors
/// The shelf's error as an answer.
pub async fn on_disk<T: Send + 'static>(
    recorder: &Recorder,
    work: impl FnOnce(&Shelf) -> Result<T, ShelfError> + Send + 'static,
) -> Result<T, Refused> {
    let shelf = Arc::clone(recorder.shelf());
    let done = tokio::task::spawn_blocking(move || work(&shelf)).await;
    let broken = |_| {
        let sentence = "reading the recordings failed; the log says why";
        Refused::new(StatusCode::INTERNAL_SERVER_ERROR, sentence)
    };
    Ok(done.map_err(broken)??)
}

//! Diagnoses of recordings: order one, read its status, cancel it, read its report.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use quell_shapers::Mode;
use schemars::JsonSchema;
use serde::Deserialize;

use super::App;
use super::answer::Refused;
use super::body::Json;
use super::recordings::{on_disk, recorder};
use super::views::fresh;
use crate::model::{Model, believed};
use crate::service::contract::Snapshot;
use crate::service::jobs::{Job, Order};
use crate::service::recorder::{About, Shelf};

/// The report has its own script and style, in a sandbox: it can neither call this service nor send data away.
const REPORT_POLICY: &str = "sandbox allow-scripts; default-src 'none'; script-src 'unsafe-inline'; \
    style-src 'unsafe-inline'; img-src data:; frame-ancestors 'self'";

/// The body of an order.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wanted {
    /// Name of the recording.
    recording: String,
    /// The model, as in `model.toml`; one of the mode that is shaped for where absent.
    model: Option<String>,
}

/// `POST /api/v1/diagnose`.
pub async fn order(
    State(app): State<Arc<App>>,
    Json(body): Json<Wanted>,
) -> Result<Response, Refused> {
    let name = body.recording.clone();
    let look = move |shelf: &Shelf| Ok((shelf.path(&name)?, shelf.about(&name)?));
    let (path, about) = on_disk(recorder(&app)?, look).await?;
    let (text, model_name) = match body.model {
        Some(text) => (text, "that was sent along".to_string()),
        None => (
            believed(&app, &about)?,
            "that the service believes".to_string(),
        ),
    };
    let model =
        Model::from_toml(&text, "model").map_err(|error| Refused::value(error.to_string()))?;
    let job = app.jobs.add(Order {
        recording: body.recording,
        path,
        model,
        model_name,
    })?;
    Ok((StatusCode::ACCEPTED, fresh(&job)).into_response())
}

/// `GET /api/v1/diagnose`.
pub async fn all(State(app): State<Arc<App>>) -> Response {
    fresh(&app.jobs.all())
}

/// `GET /api/v1/diagnose/{id}`.
pub async fn job(State(app): State<Arc<App>>, Path(id): Path<String>) -> Result<Response, Refused> {
    Ok(fresh(&known(&app, &id)?))
}

/// `DELETE /api/v1/diagnose/{id}`: the job in its present state; a running one ends within moments.
pub async fn cancel(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Response, Refused> {
    let job = known(&app, &id)?;
    Ok(fresh(&app.jobs.cancel(job.id)?))
}

/// `GET /api/v1/diagnose/{id}/report`.
pub async fn report(
    State(app): State<Arc<App>>,
    Path(id): Path<String>,
) -> Result<Response, Refused> {
    let job = known(&app, &id)?;
    let Some(report) = app.jobs.report(job.id) else {
        let sentence = format!("diagnosis {id} has no report (yet)");
        return Err(Refused::new(StatusCode::CONFLICT, sentence));
    };
    let headers = [
        (CONTENT_TYPE, "text/html; charset=utf-8"),
        (CONTENT_SECURITY_POLICY, REPORT_POLICY),
        (CACHE_CONTROL, "no-store"),
    ];
    Ok((headers, report.to_string()).into_response())
}

fn known(app: &App, id: &str) -> Result<Job, Refused> {
    let job = id.parse().ok().and_then(|id| app.jobs.job(id));
    job.ok_or_else(|| {
        let sentence = format!("there is no diagnosis {id:?}, or no longer");
        Refused::new(StatusCode::NOT_FOUND, sentence)
    })
}

/// The present belief of the joint, as a model file.
fn believed(app: &App, about: &About) -> Result<String, Refused> {
    let snapshot: Arc<Snapshot> = app.handle.snapshot();
    let joint = snapshot
        .joints
        .iter()
        .find(|joint| joint.name == about.joint);
    let value = joint.and_then(|joint| joint.mode).or(about.mode);
    let mode = value.and_then(|value| Mode::try_from(value).ok());
    let mode = mode.ok_or_else(|| {
        let sentence = format!("no mode of {} is known: give a model", about.joint);
        Refused::new(StatusCode::CONFLICT, sentence)
    })?;
    Ok(believed::flexible_joint(
        mode,
        app.settings.arcs.get(&about.joint),
    ))
}

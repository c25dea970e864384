//! The learned modes of a joint.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};

use super::App;
use super::answer::Refused;
use super::body::Nothing;
use super::commands::{Answered, ask};
use super::views::fresh;
use crate::service::contract::{JointMap, Request, ServiceError};

/// `GET /api/v1/joints/{name}/map`.
pub async fn map(
    State(app): State<Arc<App>>,
    Path(name): Path<String>,
) -> Result<Response, Refused> {
    Ok(fresh(of(&app, &name)?.as_ref()))
}

/// `GET /api/v1/joints/{name}/map.csv`.
pub async fn csv(
    State(app): State<Arc<App>>,
    Path(name): Path<String>,
) -> Result<Response, Refused> {
    let headers = [(CONTENT_TYPE, "text/csv"), (CACHE_CONTROL, "no-store")];
    Ok((headers, of(&app, &name)?.csv()).into_response())
}

/// `POST /api/v1/joints/{name}/forget`.
pub async fn forget(
    State(app): State<Arc<App>>,
    Path(joint): Path<String>,
    _: Nothing,
) -> Answered {
    ask(&app, Request::Forget { joint }).await
}

fn of(app: &App, name: &str) -> Result<Arc<JointMap>, ServiceError> {
    let snapshot = app.handle.snapshot();
    let found = snapshot.joints.iter().find(|joint| joint.name == name);
    let map = found.map(|joint| Arc::clone(&joint.map));
    let names = snapshot.joints.iter().map(|joint| joint.name.as_str());
    map.ok_or_else(|| ServiceError::unknown_joint(name, names))
}

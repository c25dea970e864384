//! The answer to a request that is refused: a status and one sentence.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use axum::http::{StatusCode, Uri};
use axum::response::{IntoResponse, Response};
use schemars::JsonSchema;
use serde::Serialize;

use super::App;
use super::counters::add;
use crate::service::contract::{ErrorKind, ServiceError};
use crate::service::jobs::{CancelError, Full};
use crate::service::recorder::{RecordError, ShelfError};

/// A refusal.
#[derive(Clone, Debug, PartialEq)]
pub struct Refused {
    status: StatusCode,
    sentence: String,
}

/// An error.
#[derive(Serialize, JsonSchema)]
pub struct Body<'a> {
    /// What is wrong, in one sentence.
    error: &'a str,
}

impl Refused {
    /// A refusal with this status and sentence.
    pub fn new(status: StatusCode, sentence: impl Into<String>) -> Self {
        Self {
            status,
            sentence: sentence.into(),
        }
    }

    /// A request that is understood, but wrong.
    pub fn value(sentence: impl Into<String>) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, sentence)
    }
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        let error = &self.sentence;
        (self.status, Json(Body { error })).into_response()
    }
}

impl From<ServiceError> for Refused {
    fn from(error: ServiceError) -> Self {
        let status = match error.kind() {
            ErrorKind::Input => StatusCode::UNPROCESSABLE_ENTITY,
            ErrorKind::Conflict => StatusCode::CONFLICT,
            ErrorKind::Storage => StatusCode::INSUFFICIENT_STORAGE,
            ErrorKind::Unavailable => StatusCode::SERVICE_UNAVAILABLE,
        };
        Self::new(status, error.to_string())
    }
}

impl From<ShelfError> for Refused {
    fn from(error: ShelfError) -> Self {
        match error {
            ShelfError::Unknown { .. } => Self::new(StatusCode::NOT_FOUND, error.to_string()),
            ShelfError::Unfinished { .. } => Self::new(StatusCode::CONFLICT, error.to_string()),
            _ => Self::new(StatusCode::INTERNAL_SERVER_ERROR, error.to_string()),
        }
    }
}

impl From<RecordError> for Refused {
    fn from(error: RecordError) -> Self {
        let status = match error {
            RecordError::Gone => StatusCode::SERVICE_UNAVAILABLE,
            RecordError::NotKept { .. } => StatusCode::INSUFFICIENT_STORAGE,
            _ => StatusCode::CONFLICT,
        };
        Self::new(status, error.to_string())
    }
}

impl From<Full> for Refused {
    fn from(error: Full) -> Self {
        Self::new(StatusCode::SERVICE_UNAVAILABLE, error.to_string())
    }
}

impl From<CancelError> for Refused {
    fn from(error: CancelError) -> Self {
        let status = match error {
            CancelError::Unknown { .. } => StatusCode::NOT_FOUND,
            CancelError::Ended { .. } => StatusCode::CONFLICT,
        };
        Self::new(status, error.to_string())
    }
}

/// For a connection beyond the limit.
pub async fn too_many(State(app): State<Arc<App>>) -> Refused {
    add(&app.counters.connections_refused);
    let sentence = "too many connections are open: only POST /api/v1/stop is taken here; try again";
    Refused::new(StatusCode::SERVICE_UNAVAILABLE, sentence)
}

/// For an unknown path.
pub async fn not_found(uri: Uri) -> Refused {
    let sentence = format!("there is nothing at {}", uri.path());
    Refused::new(StatusCode::NOT_FOUND, sentence)
}

/// For a method that the path does not have; the header `Allow` lists its methods.
pub async fn not_allowed(uri: Uri) -> Refused {
    let sentence = format!("{} does not take this method", uri.path());
    Refused::new(StatusCode::METHOD_NOT_ALLOWED, sentence)
}

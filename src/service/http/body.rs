//! The body of a request: JSON, of bounded length, in bounded time.
//!
//! The limits are here and not those of tower-http 0.7: its timeout restarts with every piece, so that a slow
//! client can hold a connection, and its answers do not name the limit.

use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, Bytes, to_bytes};
use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, StatusCode, header};
use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::App;
use super::answer::Refused;

/// Time in which a body must arrive: 64 KiB take less on any connection that can show the page. A slower client
/// would hold a connection that others need.
const PATIENCE: Duration = Duration::from_secs(1);

/// A body that must be JSON of this form.
pub struct Json<T>(pub T);

/// No body, or an empty object.
pub struct Nothing;

impl<T: DeserializeOwned> FromRequest<Arc<App>> for Json<T> {
    type Rejection = Refused;

    async fn from_request(request: Request, app: &Arc<App>) -> Result<Self, Refused> {
        // A page of another site can send other types without asking first.
        if !is_json(request.headers()) {
            let sentence = "the body must be JSON, with the header Content-Type: application/json";
            return Err(Refused::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, sentence));
        }
        let bytes = bytes(request, app.settings.max_body_bytes).await?;
        parsed(&bytes).map(Self)
    }
}

impl FromRequest<Arc<App>> for Nothing {
    type Rejection = Refused;

    async fn from_request(request: Request, app: &Arc<App>) -> Result<Self, Refused> {
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Empty {}
        let bytes = bytes(request, app.settings.max_body_bytes).await?;
        if !bytes.is_empty() {
            let Empty {} = parsed(&bytes)?;
        }
        Ok(Self)
    }
}

fn is_json(headers: &HeaderMap) -> bool {
    let kind = headers
        .get(header::CONTENT_TYPE)
        .and_then(|kind| kind.to_str().ok());
    let essence = kind
        .and_then(|kind| kind.split(';').next())
        .unwrap_or_default();
    essence.trim().eq_ignore_ascii_case("application/json")
}

async fn bytes(request: Request, most: usize) -> Result<Bytes, Refused> {
    let declared = request.headers().get(header::CONTENT_LENGTH);
    let declared = declared.and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    let too_long = || {
        let sentence = format!("the body is longer than {most} bytes");
        Refused::new(StatusCode::PAYLOAD_TOO_LARGE, sentence)
    };
    if declared.is_some_and(|length| length > most as u64) {
        return Err(too_long());
    }
    let body: Body = request.into_body();
    match tokio::time::timeout(PATIENCE, to_bytes(body, most)).await {
        Ok(Ok(bytes)) => Ok(bytes),
        // Else the connection broke, and there is no reader for an answer.
        Ok(Err(_)) => Err(too_long()),
        Err(_) => {
            let sentence = format!("the body was not here within {} s", PATIENCE.as_secs());
            Err(Refused::new(StatusCode::REQUEST_TIMEOUT, sentence))
        }
    }
}

fn parsed<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Refused> {
    let refused = |reason: String| {
        let sentence = format!("the body is not what it should be: {reason}");
        Refused::new(StatusCode::BAD_REQUEST, sentence)
    };
    // Serde accepts an array for an object's values in their order, but a robot is moved by names only.
    if bytes.trim_ascii_start().starts_with(b"[") {
        return Err(refused("an object is wanted, not an array".into()));
    }
    serde_json::from_slice(bytes).map_err(|error| refused(error.to_string()))
}

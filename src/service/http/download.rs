//! One recording to take along, a few at once.

use std::convert::Infallible;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use axum::body::{Body, Bytes};
use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use hyper::body::{Frame, SizeHint};
use tokio::sync::OwnedSemaphorePermit;

use super::App;
use super::answer::Refused;
use super::recordings::{on_disk, recorder};

/// `GET /api/recordings/{name}`.
pub async fn download(
    State(app): State<Arc<App>>,
    Path(name): Path<String>,
) -> Result<Response, Refused> {
    let recorder = recorder(&app)?;
    let place = Arc::clone(&app.downloads).try_acquire_owned();
    let place = place.map_err(|_| {
        let sentence = "too many recordings are being sent; try again when one has arrived";
        Refused::new(StatusCode::SERVICE_UNAVAILABLE, sentence)
    })?;
    let wanted = name.clone();
    let archive = on_disk(recorder, move |shelf| shelf.archive(&wanted)).await?;
    // A name that the shelf has is letters, digits, -, _ and dots.
    let disposition = format!("attachment; filename=\"{name}.tar\"");
    let headers = [
        (CONTENT_TYPE, "application/x-tar".to_string()),
        (CONTENT_DISPOSITION, disposition),
    ];
    let body = Body::new(Held {
        rest: archive.into(),
        _place: place,
    });
    Ok((headers, body).into_response())
}

/// Bytes that are handed on at once: what is handed on is no longer held here.
const PART: usize = 64 * 1024;

/// A body that keeps its place until it is sent.
struct Held {
    rest: Bytes,
    _place: OwnedSemaphorePermit,
}

impl hyper::body::Body for Held {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        _: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        let length = self.rest.len().min(PART);
        let part = self.rest.split_to(length);
        Poll::Ready((length > 0).then(|| Ok(Frame::data(part))))
    }

    fn size_hint(&self) -> SizeHint {
        SizeHint::with_exact(self.rest.len() as u64)
    }
}

//! One recording to take along, a few at once.

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
        body: archive.into(),
        _place: place,
    });
    Ok((headers, body).into_response())
}

/// A body that keeps its place until it is sent.
struct Held {
    body: Body,
    _place: OwnedSemaphorePermit,
}

impl hyper::body::Body for Held {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

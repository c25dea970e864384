//! Download of a recording; only a few run at once.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_LENGTH, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};

use super::App;
use super::answer::Refused;
use super::pieces::in_pieces;
use super::recordings::{on_disk, recorder};

/// `GET /api/v1/recordings/{name}`.
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
    let length = archive.length();
    // A name on the shelf consists of letters, digits, -, _ and dots.
    let disposition = format!("attachment; filename=\"{name}.tar\"");
    let headers = [
        (CONTENT_TYPE, "application/x-tar".to_string()),
        (CONTENT_DISPOSITION, disposition),
        (CONTENT_LENGTH, length.to_string()),
    ];
    let body = in_pieces(length, move |out| {
        // Held until the reading thread is free again.
        let _place = place;
        archive.write(out)
    });
    Ok((headers, body).into_response())
}

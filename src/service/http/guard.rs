//! The checks of every request: its origin, and its token.

use std::net::IpAddr;
use std::sync::Arc;

use axum::extract::{Query, Request, State};
use axum::http::uri::Authority;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use subtle::ConstantTimeEq;

use super::App;
use super::answer::Refused;

/// Headers of every answer: no type guessing, no embedding, no referrer.
const HEADERS: [(HeaderName, &str); 3] = [
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (
        HeaderName::from_static("cross-origin-resource-policy"),
        "same-origin",
    ),
];

#[derive(Deserialize)]
struct InQuery {
    token: Option<String>,
}

/// Passes a request on, or refuses it; counts it; and makes every error a sentence in JSON.
pub async fn guard(State(app): State<Arc<App>>, request: Request, next: Next) -> Response {
    let mut response = match admitted(&app, &request) {
        Ok(()) => next.run(request).await,
        Err(refused) => refused.into_response(),
    };
    app.counters.answered(response.status());
    if is_error_without_sentence(&response) {
        let reason = response
            .status()
            .canonical_reason()
            .unwrap_or("unknown error");
        response = Refused::new(response.status(), reason.to_lowercase()).into_response();
    }
    for (name, value) in HEADERS {
        response
            .headers_mut()
            .insert(name, HeaderValue::from_static(value));
    }
    response
}

/// Whether it is an error of the library itself, for example of a failed WebSocket upgrade, which is plain
/// text.
fn is_error_without_sentence(response: &Response) -> bool {
    let status = response.status();
    let json = HeaderValue::from_static("application/json");
    (status.is_client_error() || status.is_server_error())
        && response.headers().get(header::CONTENT_TYPE) != Some(&json)
}

fn admitted(app: &App, request: &Request) -> Result<(), Refused> {
    let headers = request.headers();
    let host = host(request.uri(), headers);
    match &app.settings.token {
        Some(token) => bearer(token, request)?,
        None => local(host.as_ref())?,
    }
    origin(headers, host.as_ref())
}

/// The host that the request is for.
fn host(uri: &Uri, headers: &HeaderMap) -> Option<Authority> {
    let header = headers
        .get(header::HOST)
        .and_then(|host| host.to_str().ok());
    let named = header.and_then(|host| host.parse().ok());
    uri.authority().cloned().or(named)
}

/// Without a token, only requests to this machine by name are accepted. Otherwise a page of another site could
/// have its own name resolved to 127.0.0.1 after it was loaded (DNS rebinding), and pass for a page of this
/// service. Its requests carry that name as the host.
fn local(host: Option<&Authority>) -> Result<(), Refused> {
    let name = host.map(Authority::host).unwrap_or_default();
    let bare = name.trim_start_matches('[').trim_end_matches(']');
    let address = bare
        .parse::<IpAddr>()
        .is_ok_and(|address| address.is_loopback());
    if address || bare.eq_ignore_ascii_case("localhost") {
        return Ok(());
    }
    let sentence = format!("the host {name:?} is not this machine: ask for localhost or 127.0.0.1");
    Err(Refused::new(StatusCode::FORBIDDEN, sentence))
}

/// A browser states the site of a request. Another site may neither command the robot (a form or script can
/// post without reading the answer) nor listen: WebSockets have no other protection.
fn origin(headers: &HeaderMap, host: Option<&Authority>) -> Result<(), Refused> {
    let Some(origin) = headers.get(header::ORIGIN) else {
        return Ok(());
    };
    let from = origin
        .to_str()
        .ok()
        .and_then(|origin| origin.parse::<Uri>().ok());
    let from = from.as_ref().and_then(Uri::authority);
    match from.is_some() && from == host {
        true => Ok(()),
        false => Err(Refused::new(
            StatusCode::FORBIDDEN,
            "the request comes from a page of another site",
        )),
    }
}

/// The page's own files are public; everything else needs the token. A browser cannot add a header to a
/// WebSocket, a download or a frame, so that read-only requests may carry it as `?token=`.
fn bearer(token: &str, request: &Request) -> Result<(), Refused> {
    let path = request.uri().path();
    if !path.starts_with("/api/") && path != "/metrics" {
        return Ok(());
    }
    let header = request.headers().get(header::AUTHORIZATION);
    let header = header.and_then(|value| value.to_str().ok()?.strip_prefix("Bearer "));
    let reads = request.method() == Method::GET;
    let query = Query::<InQuery>::try_from_uri(request.uri()).ok();
    let query = query.and_then(|Query(query)| query.token);
    let given = header.or(query.as_deref().filter(|_| reads));
    // In constant time: the duration must not show how many letters are right.
    if given.is_some_and(|given| given.as_bytes().ct_eq(token.as_bytes()).into()) {
        return Ok(());
    }
    let sentence = "the token is missing or wrong: send the header Authorization: Bearer <token>";
    Err(Refused::new(StatusCode::UNAUTHORIZED, sentence))
}

//! HTTP, WebSocket and the page.
//!
//! [`routes`] has every path, method and body; `GET /openapi.json` describes them. Paths are versioned:
//! `/api/v1/...`. The old paths without a version are aliases, and their answers are marked as deprecated.
//!
//! Any error is `{"error": "a sentence"}`. Every resource that a client can consume is bounded: bodies,
//! headers, connections, streams, downloads, waiting jobs, and their times. A stop has reserved connections,
//! and reserved room in the engine's queue.

mod answer;
mod body;
mod commands;
mod connections;
mod counters;
mod diagnose;
mod download;
mod guard;
mod metrics;
mod modes;
mod openapi;
mod pace;
mod page;
mod pieces;
mod recordings;
mod route;
mod routes;
mod stream;
mod views;
mod wire;

use std::collections::BTreeMap;
use std::future::Future;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::middleware::from_fn_with_state;
use axum::routing::post;
use thiserror::Error;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;

use super::contract::Handle;
use super::jobs::{Jobs, Report};
use super::recorder::Recorder;
use crate::signal::JointArc;
use connections::Answers;
use counters::Counters;
use stream::Feed;

/// The shortest token, bytes: 16 random ones are not guessed.
const SHORTEST_TOKEN: usize = 16;
/// WebSockets open at once; they do not count as connections.
const STREAMS: usize = 64;
/// Downloads at once: each occupies a thread.
const DOWNLOADS: usize = 4;

/// Settings of the HTTP interface.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The token that every request must carry; needed where the address is not loopback.
    pub token: Option<String>,
    /// Most connections at once.
    pub max_connections: usize,
    /// Longest body of a request, bytes.
    pub max_body_bytes: usize,
    /// Geometry of the tip's circle about each joint, by name, for the diagnosis of a measured tip.
    pub arcs: BTreeMap<String, JointArc>,
    /// The recorder; `None` if recording is off.
    pub recorder: Option<Recorder>,
    /// The function that makes the report of a diagnosis.
    pub report: Report,
    /// Time after which a diagnosis is given up.
    pub diagnosis_limit: Duration,
}

/// Why the service does not listen.
#[derive(Debug, Error)]
pub enum HttpError {
    /// An address that other machines reach, without a token.
    #[error(
        "{address} can be reached from other machines: give a token (http.token in the configuration), \
         or listen on 127.0.0.1"
    )]
    NeedsToken {
        /// The address.
        address: SocketAddr,
    },
    /// A token that can be guessed or cannot be sent.
    #[error("http.token must have {SHORTEST_TOKEN} or more characters, each of them visible ASCII")]
    Token,
    /// An error of the system.
    #[error("HTTP: {0}")]
    System(#[from] std::io::Error),
}

/// The state of all handlers.
struct App {
    handle: Handle,
    settings: Settings,
    counters: Counters,
    feed: Feed,
    jobs: Jobs,
    streams: Arc<Semaphore>,
    downloads: Arc<Semaphore>,
    demo: Arc<Semaphore>,
}

/// Checks the address and the token.
///
/// # Errors
/// [`HttpError::NeedsToken`] for an address that is not loopback without a token, [`HttpError::Token`] for a
/// token that is too short.
pub fn check(address: SocketAddr, token: Option<&str>) -> Result<(), HttpError> {
    match token {
        None if !address.ip().to_canonical().is_loopback() => {
            Err(HttpError::NeedsToken { address })
        }
        Some(token)
            if token.len() < SHORTEST_TOKEN || !token.bytes().all(|b| b.is_ascii_graphic()) =>
        {
            Err(HttpError::Token)
        }
        _ => Ok(()),
    }
}

/// Serves until `shutdown`; requests that have begun get a few seconds more.
///
/// # Errors
/// [`HttpError`] where the address needs a token, or the system cannot create a thread.
pub async fn serve(
    listener: TcpListener,
    handle: Handle,
    settings: Settings,
    shutdown: impl Future<Output = ()>,
) -> Result<(), HttpError> {
    check(listener.local_addr()?, settings.token.as_deref())?;
    let most = settings.max_connections;
    let app = app(handle, settings)?;
    let answers = Answers {
        all: router(Arc::clone(&app)),
        stop_only: stop_only(Arc::clone(&app)),
    };
    connections::accept(listener, answers, most, &app, shutdown).await;
    Ok(())
}

/// The routes of [`serve`] without a socket: for a test, or behind a server of one's own that checks its
/// clients.
///
/// # Errors
/// [`HttpError::System`] where the system cannot create a thread.
///
/// # Panics
/// Outside a runtime of tokio.
pub fn routes(handle: Handle, settings: Settings) -> Result<Router, HttpError> {
    Ok(router(app(handle, settings)?))
}

fn app(handle: Handle, settings: Settings) -> Result<Arc<App>, HttpError> {
    Ok(Arc::new(App {
        feed: Feed::start(&handle),
        jobs: Jobs::start(settings.report, settings.diagnosis_limit)?,
        handle,
        settings,
        counters: Counters::default(),
        streams: Arc::new(Semaphore::new(STREAMS)),
        downloads: Arc::new(Semaphore::new(DOWNLOADS)),
        demo: Arc::new(Semaphore::new(1)),
    }))
}

fn router(app: Arc<App>) -> Router {
    let api = routes::add_all(Router::new());
    page::routes(api)
        .fallback(answer::not_found)
        .method_not_allowed_fallback(answer::not_allowed)
        .layer(from_fn_with_state(Arc::clone(&app), guard::guard))
        .with_state(app)
}

/// The answers on a connection beyond the limit: a stop is executed, all else is refused.
fn stop_only(app: Arc<App>) -> Router {
    Router::new()
        .route("/api/v1/stop", post(commands::stop))
        .route("/api/stop", post(commands::stop))
        .fallback(answer::too_many)
        .method_not_allowed_fallback(answer::too_many)
        .layer(from_fn_with_state(Arc::clone(&app), guard::guard))
        .with_state(app)
}

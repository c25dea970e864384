//! The routes of the interface: one line for each path and method. Router and `/openapi.json` loop over it.

use std::sync::{Arc, LazyLock};

use axum::http::{HeaderValue, header};
use axum::middleware::map_response;
use axum::response::Response;
use axum::routing::{MethodRouter, delete, get, post};
use axum::{Json, Router};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::Value;

use super::commands::{Feed, Jogged, Payload, Travel};
use super::diagnose::Wanted;
use super::recordings::{Record, Recorded};
use super::route::{Answer, Route, Shape};
use super::views::Estimate;
use super::{
    App, commands, diagnose, download, metrics, modes, openapi, recordings, stream, views,
};
use crate::service::contract::{Accepted, JointMap, ShapingChange, Snapshot};
use crate::service::jobs::Job;
use crate::service::recorder::Entry;

/// Prefix before there were versions. Deprecated; an alias of [`VERSION`](super::route::VERSION).
const UNVERSIONED: &str = "/api";
/// Date of the deprecation in the form of RFC 9745: 2026-11-23.
const DEPRECATED: &str = "@1795392000";

fn shape<T: JsonSchema>(generator: &mut SchemaGenerator) -> Schema {
    generator.subschema_for::<T>()
}

const fn read(
    path: &'static str,
    summary: &'static str,
    answer: Answer,
    handler: fn() -> MethodRouter<Arc<App>>,
) -> Route {
    Route {
        method: "get",
        path,
        versioned: true,
        summary,
        body: None,
        status: "200",
        answer,
        handler,
    }
}

const fn command(
    path: &'static str,
    summary: &'static str,
    body: Option<Shape>,
    answer: Answer,
    handler: fn() -> MethodRouter<Arc<App>>,
) -> Route {
    Route {
        method: "post",
        body,
        ..read(path, summary, answer, handler)
    }
}

const ACCEPTED: Answer = Answer::Json(shape::<Accepted>);

/// All routes.
pub const ROUTES: &[Route] = &[
    read(
        "/state",
        "The state of everything now.",
        Answer::Json(shape::<Snapshot>),
        || get(views::state),
    ),
    read(
        "/estimates",
        "The estimates of every joint.",
        Answer::Json(shape::<Vec<Estimate>>),
        || get(views::estimates),
    ),
    Route {
        status: "101",
        ..read(
            "/stream",
            "A WebSocket: the state, batches of frames and events, and what a slow reader lost.",
            Answer::Other("application/json", "Messages of the stream."),
            || get(stream::stream),
        )
    },
    command(
        "/enable",
        "Lets moves begin. Nothing moves by this alone.",
        None,
        ACCEPTED,
        || post(commands::enable),
    ),
    command(
        "/disable",
        "Stops every joint, and lets no move begin.",
        None,
        ACCEPTED,
        || post(commands::disable),
    ),
    command(
        "/reset",
        "Takes a fault back, once somebody has seen to it. Moves stay disabled.",
        None,
        ACCEPTED,
        || post(commands::reset),
    ),
    command(
        "/move",
        "Moves one joint, from rest or in mid-move; or several from rest, which begin and end together.",
        Some(shape::<Travel>),
        ACCEPTED,
        || post(commands::travel),
    ),
    command(
        "/jog",
        "Moves a joint for 0.25 s more, while somebody holds a button; then it stops.",
        Some(shape::<Jogged>),
        ACCEPTED,
        || post(commands::jog),
    ),
    command(
        "/feed",
        "Moves go on, and begin, at a share of full speed, on the same path. At 0 all stops.",
        Some(shape::<Feed>),
        ACCEPTED,
        || post(commands::feed),
    ),
    command(
        "/demo",
        "Moves the simulated arm unshaped, shaped for a wrong mode, and adapted, one after the other. Enables moves.",
        None,
        ACCEPTED,
        || post(commands::demonstrate),
    ),
    command(
        "/stop",
        "Brings every joint to a jerk-limited stop. This is not an emergency stop.",
        None,
        ACCEPTED,
        || post(commands::stop),
    ),
    command(
        "/shaper",
        "Changes how commands are shaped.",
        Some(shape::<ShapingChange>),
        ACCEPTED,
        || post(commands::shaper),
    ),
    command(
        "/payload",
        "Declares the payload; the embedded arm takes it up.",
        Some(shape::<Payload>),
        ACCEPTED,
        || post(commands::payload),
    ),
    read(
        "/joints/{name}/map",
        "The modes that moves have taught of a joint, over its pose, as well as they are known.",
        Answer::Json(shape::<JointMap>),
        || get(modes::map),
    ),
    read(
        "/joints/{name}/map.csv",
        "The curves of the same.",
        Answer::Other("text/csv", "A line a mode and position."),
        || get(modes::csv),
    ),
    command(
        "/joints/{name}/forget",
        "Forgets what moves have taught of a joint. The mode of the configuration is believed again.",
        None,
        ACCEPTED,
        || post(modes::forget),
    ),
    read(
        "/recordings",
        "The recordings, oldest first.",
        Answer::Json(shape::<Vec<Entry>>),
        || get(recordings::list),
    ),
    command(
        "/recordings",
        "Begins or ends a recording on demand.",
        Some(shape::<Record>),
        Answer::Json(shape::<Recorded>),
        || post(recordings::record),
    ),
    read(
        "/recordings/{name}",
        "One recording: manifest, CSV and MCAP.",
        Answer::Other("application/x-tar", "A tar archive."),
        || get(download::download),
    ),
    read(
        "/diagnose",
        "All diagnoses.",
        Answer::Json(shape::<Vec<Job>>),
        || get(diagnose::all),
    ),
    Route {
        status: "202",
        ..command(
            "/diagnose",
            "Orders the diagnosis of a recording.",
            Some(shape::<Wanted>),
            Answer::Json(shape::<Job>),
            || post(diagnose::order),
        )
    },
    read(
        "/diagnose/{id}",
        "One diagnosis: progress, and verdict once there is one.",
        Answer::Json(shape::<Job>),
        || get(diagnose::job),
    ),
    Route {
        method: "delete",
        ..read(
            "/diagnose/{id}",
            "Cancels a diagnosis that waits or runs.",
            Answer::Json(shape::<Job>),
            || delete(diagnose::cancel),
        )
    },
    read(
        "/diagnose/{id}/report",
        "The report of a diagnosis, a page.",
        Answer::Other("text/html", "A page."),
        || get(diagnose::report),
    ),
    Route {
        versioned: false,
        ..read(
            "/metrics",
            "Everything that is counted, for Prometheus.",
            Answer::Other("text/plain", "Prometheus text, format 0.0.4."),
            || get(metrics::metrics),
        )
    },
    Route {
        versioned: false,
        ..read(
            "/openapi.json",
            "This description.",
            Answer::Other("application/json", "OpenAPI 3.1."),
            || get(describe),
        )
    },
];

/// `GET /openapi.json`.
async fn describe() -> Json<&'static Value> {
    static DOCUMENT: LazyLock<Value> = LazyLock::new(|| openapi::document(ROUTES));
    Json(&DOCUMENT)
}

/// Adds all routes, with the old paths of those that have one.
pub fn add_all(router: Router<Arc<App>>) -> Router<Arc<App>> {
    ROUTES.iter().fold(router, |router, route| {
        let router = router.route(&route.whole(), (route.handler)());
        match route.versioned {
            true => router.route(&format!("{UNVERSIONED}{}", route.path), alias(route)),
            false => router,
        }
    })
}

/// The handler under its old path; its answers are marked as deprecated (RFC 9745).
fn alias(route: &Route) -> MethodRouter<Arc<App>> {
    (route.handler)().layer(map_response(async |mut response: Response| {
        let headers = response.headers_mut();
        headers.insert("deprecation", HeaderValue::from_static(DEPRECATED));
        let successor = "</openapi.json>; rel=\"successor-version\"";
        headers.insert(header::LINK, HeaderValue::from_static(successor));
        response
    }))
}

//! The page and what it is drawn with, all of it inside the program.

use std::sync::Arc;

use axum::Router;
use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use axum::routing::get;

use super::App;

/// Nothing from elsewhere, and nobody else's frame: a button under another page's picture would move
/// the robot.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
    connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const JS: &str = "text/javascript; charset=utf-8";
const SVG: &str = "image/svg+xml";

/// Path, type and text of each file.
const FILES: [(&str, &str, &str); 8] = [
    (
        "/",
        HTML,
        include_str!("../../../assets/service/index.html"),
    ),
    (
        "/service.css",
        CSS,
        include_str!("../../../assets/service/service.css"),
    ),
    (
        "/service.js",
        JS,
        include_str!("../../../assets/service/service.js"),
    ),
    (
        "/charts.js",
        JS,
        include_str!("../../../assets/service/charts.js"),
    ),
    (
        "/icon.svg",
        SVG,
        include_str!("../../../assets/service/icon.svg"),
    ),
    (
        "/report.css",
        CSS,
        include_str!("../../../assets/report.css"),
    ),
    (
        "/uplot.js",
        JS,
        include_str!("../../../assets/uplot-1.6.32/uPlot.iife.min.js"),
    ),
    (
        "/uplot.css",
        CSS,
        include_str!("../../../assets/uplot-1.6.32/uPlot.min.css"),
    ),
];

/// Adds the page's files to the routes.
pub fn routes(router: Router<Arc<App>>) -> Router<Arc<App>> {
    FILES
        .into_iter()
        .fold(router, |router, (path, kind, text)| {
            router.route(path, get(async move || file(kind, text)))
        })
}

fn file(kind: &'static str, text: &'static str) -> Response {
    let headers = [
        (CONTENT_TYPE, kind),
        (CONTENT_SECURITY_POLICY, POLICY),
        // The program may be another one tomorrow, at the same address.
        (CACHE_CONTROL, "no-cache"),
    ];
    (headers, text).into_response()
}

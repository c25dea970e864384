//! The page and its files, compiled into the program.

use std::sync::Arc;

use axum::Router;
use axum::http::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use axum::routing::get;

use super::App;

/// No content from elsewhere, and no embedding: under a picture of another page a click on a button would move
/// the robot.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; \
    connect-src 'self'; frame-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const JS: &str = "text/javascript; charset=utf-8";
const SVG: &str = "image/svg+xml";

const PAGE: &str = include_str!("../../../assets/service/index.html");
const STYLE: &str = include_str!("../../../assets/service/service.css");
const SCRIPT: &str = include_str!("../../../assets/service/service.js");
const ASK: &str = include_str!("../../../assets/service/ask.js");
const DOM: &str = include_str!("../../../assets/service/dom.js");
const JOG: &str = include_str!("../../../assets/service/jog.js");
const KEYS: &str = include_str!("../../../assets/service/keys.js");
const MODES: &str = include_str!("../../../assets/service/modes.js");
const MOVES: &str = include_str!("../../../assets/service/moves.js");
const CHARTS: &str = include_str!("../../../assets/service/charts.js");
const TICKS: &str = include_str!("../../../assets/service/ticks.js");
const RECORDINGS: &str = include_str!("../../../assets/service/recordings.js");
const ICON: &str = include_str!("../../../assets/service/icon.svg");

/// Path, type and text of each file.
const FILES: [(&str, &str, &str); 16] = [
    ("/", HTML, PAGE),
    ("/service.css", CSS, STYLE),
    ("/service.js", JS, SCRIPT),
    ("/ask.js", JS, ASK),
    ("/charts.js", JS, CHARTS),
    ("/dom.js", JS, DOM),
    ("/jog.js", JS, JOG),
    ("/keys.js", JS, KEYS),
    ("/modes.js", JS, MODES),
    ("/moves.js", JS, MOVES),
    ("/recordings.js", JS, RECORDINGS),
    ("/ticks.js", JS, TICKS),
    ("/icon.svg", SVG, ICON),
    ("/report.css", CSS, quell_page::STYLE),
    ("/uplot.js", JS, quell_page::UPLOT_SCRIPT),
    ("/uplot.css", CSS, quell_page::UPLOT_STYLE),
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
        // A later version of the program may use the same address.
        (CACHE_CONTROL, "no-cache"),
    ];
    (headers, text).into_response()
}

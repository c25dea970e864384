//! The description of a path and method of the interface.

use std::sync::Arc;

use axum::routing::MethodRouter;
use schemars::{Schema, SchemaGenerator};

use super::App;

/// Prefix of the paths of this version.
pub const VERSION: &str = "/api/v1";
/// The schema of a body.
pub type Shape = fn(&mut SchemaGenerator) -> Schema;

/// The answer to an accepted request.
#[derive(Clone, Copy)]
pub enum Answer {
    /// JSON of this form.
    Json(Shape),
    /// Another type: its media type, and its description.
    Other(&'static str, &'static str),
}

/// A path and a method.
pub struct Route {
    /// The method, in lower case.
    pub method: &'static str,
    /// The path after [`VERSION`]; the whole path if it has no version.
    pub path: &'static str,
    /// Whether the path is below [`VERSION`].
    pub versioned: bool,
    /// A description in one sentence.
    pub summary: &'static str,
    /// The body, if it takes one.
    pub body: Option<Shape>,
    /// The status of a successful answer.
    pub status: &'static str,
    /// The answer.
    pub answer: Answer,
    /// Its handler.
    pub handler: fn() -> MethodRouter<Arc<App>>,
}

impl Route {
    /// The whole path.
    pub fn whole(&self) -> String {
        let before = if self.versioned { VERSION } else { "" };
        format!("{before}{}", self.path)
    }
}

//! What is known of a path and a method of the interface.

use std::sync::Arc;

use axum::routing::MethodRouter;
use schemars::{Schema, SchemaGenerator};

use super::App;

/// Where the paths of this version begin.
pub const VERSION: &str = "/api/v1";
/// The schema of a body.
pub type Shape = fn(&mut SchemaGenerator) -> Schema;

/// What is answered where a request is taken.
#[derive(Clone, Copy)]
pub enum Answer {
    /// JSON of this form.
    Json(Shape),
    /// Something else: its type, and what it is.
    Other(&'static str, &'static str),
}

/// A path and a method.
pub struct Route {
    /// The method, in small letters.
    pub method: &'static str,
    /// The path after [`VERSION`]; or the whole path, where it has no version.
    pub path: &'static str,
    /// Whether the path is below [`VERSION`].
    pub versioned: bool,
    /// One sentence of it.
    pub summary: &'static str,
    /// The body, if it takes one.
    pub body: Option<Shape>,
    /// The status of an answer that is no error.
    pub status: &'static str,
    /// The answer.
    pub answer: Answer,
    /// What answers it.
    pub handler: fn() -> MethodRouter<Arc<App>>,
}

impl Route {
    /// The whole path.
    pub fn whole(&self) -> String {
        let before = if self.versioned { VERSION } else { "" };
        format!("{before}{}", self.path)
    }
}

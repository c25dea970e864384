//! The interface as an OpenAPI 3.1 document, from the table of routes and the types of the bodies.

use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value, json};

use super::answer::Body;
use super::route::{Answer, Route};

/// The description of these routes.
pub fn document(routes: &[Route]) -> Value {
    // OpenAPI 3.1 uses JSON Schema 2020-12 unchanged.
    let settings = SchemaSettings::draft2020_12();
    let mut generator = settings
        .with(|settings| settings.definitions_path = "/components/schemas".into())
        .into_generator();
    let mut paths = Map::new();
    for route in routes {
        let methods = paths.entry(route.whole()).or_insert_with(|| json!({}));
        methods[route.method] = operation(route, &mut generator);
    }
    let schemas = generator.take_definitions(true);
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "Quell",
            "version": env!("CARGO_PKG_VERSION"),
            "description": "Commands a robot in real time. Stop is not an emergency stop. After the start and after a \
                fault no move begins until it is enabled.",
            "license": {"name": "MIT OR Apache-2.0"},
        },
        "paths": paths,
        "components": {
            "schemas": schemas,
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer"}},
        },
        // A service on loopback may have no token.
        "security": [{}, {"token": []}],
    })
}

fn operation(route: &Route, generator: &mut SchemaGenerator) -> Value {
    let answer = match route.answer {
        Answer::Json(shape) => json!({
            "description": "It was done.",
            "content": {"application/json": {"schema": shape(generator)}},
        }),
        Answer::Other(kind, what) => json!({"description": what, "content": {kind: {}}}),
    };
    let error = Body::json_schema(generator);
    let mut operation = json!({
        "operationId": id(route),
        "summary": route.summary,
        "responses": {
            route.status: answer,
            "default": {
                "description": "Refused, with a sentence that says why. 409: not now, as while moves are not enabled.",
                "content": {"application/json": {"schema": error}},
            },
        },
    });
    if let Some(body) = route.body {
        operation["requestBody"] = json!({
            "required": true,
            "content": {"application/json": {"schema": body(generator)}},
        });
    }
    let parameters: Vec<_> = route
        .path
        .split('/')
        .filter_map(|part| part.strip_prefix('{')?.strip_suffix('}'))
        .map(|name| {
            json!({"name": name, "in": "path", "required": true, "schema": {"type": "string"}})
        })
        .collect();
    if !parameters.is_empty() {
        operation["parameters"] = json!(parameters);
    }
    operation
}

/// An unused operation id.
fn id(route: &Route) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let path: String = route.path.chars().map(plain).collect();
    format!("{}{}", route.method, path.trim_end_matches('_'))
}

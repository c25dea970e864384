//! The interface over HTTP, from what the service answers at `/openapi.json`.

use super::super::service::Service;
use super::{plain, table};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::LazyLock;

pub fn paths() -> BTreeSet<String> {
    let document = document();
    document["paths"]
        .as_object()
        .unwrap()
        .keys()
        .cloned()
        .collect()
}

/// Asked of a service once.
fn document() -> &'static Value {
    static DOCUMENT: LazyLock<Value> = LazyLock::new(|| {
        let folder = tempfile::tempdir().unwrap();
        let service = Service::start(&["--data", folder.path().to_str().unwrap()]);
        let (_, answer) = service.ask("GET", "/openapi.json", "");
        serde_json::from_str(&answer).unwrap()
    });
    &DOCUMENT
}

pub fn page() -> String {
    let document = document();
    let mut page = String::from(
        "# HTTP interface\n\n[The live service](../guide/service.md) shows how it is used. The service itself answers \
         this page's source at `/openapi.json` (OpenAPI 3.1). An error is `{\"error\": \"one sentence\"}`. Paths \
         without `/v1` are deprecated aliases.\n\n## Paths\n\n",
    );
    let paths = document["paths"].as_object().unwrap();
    let operations = paths.iter().flat_map(|(path, methods)| {
        let methods = methods.as_object().unwrap().iter();
        methods.map(move |(method, operation)| (path, method, operation))
    });
    let rows = operations.map(|(path, method, operation)| row(path, method, operation));
    page += &table(["request", "what it does", "body", "answer"], rows);
    page += "## Objects\n\n";
    for (name, schema) in document["components"]["schemas"].as_object().unwrap() {
        page += &format!("### {name}\n\n{}", object(schema));
    }
    page
}

/// Request, summary, body and answers.
fn row(path: &str, method: &str, operation: &Value) -> [String; 4] {
    let schema = |holder: &Value| holder["content"]["application/json"]["schema"].clone();
    let answers = operation["responses"].as_object().unwrap().iter();
    let answers = answers.filter(|(status, _)| *status != "default");
    let answers = answers.map(|(status, answer)| {
        let words = answer["description"].as_str().unwrap_or_default();
        match schema(answer) {
            Value::Null => format!("{status}: {words}"),
            body => format!("{status}: {}", kind(&body)),
        }
    });
    let answers: Vec<_> = answers.collect();
    let summary = operation["summary"].as_str().unwrap_or_default();
    let body = match schema(&operation["requestBody"]) {
        Value::Null => String::new(),
        body => kind(&body),
    };
    let name = format!("`{} {path}`", method.to_uppercase());
    [name, summary.into(), body, answers.join(", ")]
}

fn words(schema: &Value) -> String {
    let words = schema["description"].as_str().unwrap_or_default();
    plain(&words.split_whitespace().collect::<Vec<_>>().join(" "))
}

fn object(schema: &Value) -> String {
    let mut text = words(schema);
    if !text.is_empty() {
        text += "\n\n";
    }
    if let Some(properties) = schema["properties"].as_object() {
        text += &fields(schema, properties);
    }
    let ways = schema["oneOf"].as_array().into_iter().flatten();
    let (named, others): (Vec<&Value>, Vec<&Value>) =
        ways.partition(|way| way["const"].is_string());
    if !named.is_empty() {
        let rows = named
            .iter()
            .map(|way| [format!("`{}`", way["const"].as_str().unwrap()), words(way)]);
        text += &table(["value", "what"], rows);
    }
    for way in others {
        text += &object(way);
    }
    text
}

fn fields(schema: &Value, properties: &serde_json::Map<String, Value>) -> String {
    let required: Vec<_> = schema["required"]
        .as_array()
        .into_iter()
        .flatten()
        .collect();
    let rows = properties.iter().map(|(name, value)| {
        let needed = required.iter().any(|one| one.as_str() == Some(name));
        let needed = if needed { "yes" } else { "" };
        [
            format!("`{name}`"),
            kind(value),
            needed.into(),
            match value["const"].is_string() {
                true => "Says which one it is.".into(),
                false => words(value),
            },
        ]
    });
    table(["key", "type", "always", "what"], rows)
}

/// A type in words.
fn kind(schema: &Value) -> String {
    if let Some(name) = schema["$ref"].as_str() {
        let name = name.rsplit('/').next().unwrap_or_default();
        return format!("[{name}](#{})", name.to_lowercase());
    }
    if let Some(value) = schema["const"].as_str() {
        return format!("`{value}`");
    }
    let any = schema["anyOf"].as_array().into_iter().flatten();
    if let Some(inner) = any.into_iter().find(|one| one["type"] != "null") {
        return kind(inner);
    }
    let name = match &schema["type"] {
        Value::Array(names) => names
            .iter()
            .find(|name| *name != "null")
            .and_then(Value::as_str),
        name => name.as_str(),
    };
    match name {
        Some("array") if schema["items"].is_object() => {
            format!("list of {}", kind(&schema["items"]))
        }
        Some("array") => "list".into(),
        Some("integer") => "whole number".into(),
        Some("boolean") => "true or false".into(),
        Some("string") => "text".into(),
        Some(other) => other.to_string(),
        None => "any".into(),
    }
}

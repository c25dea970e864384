//! A listing of every key of `quell.toml`, generated from the types that read it; as a file it changes nothing.

use std::fmt::Write;

use schemars::generate::SchemaSettings;
use serde_json::Value;

use super::keys::Keys;

/// Units by the suffix of a key; the longest first.
const UNITS: [(&str, &str); 9] = [
    ("_deg_s2", "deg/s^2"),
    ("_deg_s3", "deg/s^3"),
    ("_deg_s", "deg/s"),
    ("_deg", "deg"),
    ("_hz", "Hz"),
    ("_mb", "MB"),
    ("_bytes", "bytes"),
    ("_ratio", "a ratio"),
    ("_s", "s"),
];

/// All keys, with their defaults, units, ranges and a sentence each, as TOML. Keys without a default are
/// comments.
pub fn listed() -> String {
    let settings = SchemaSettings::draft2020_12();
    let inline = settings.with(|settings| settings.inline_subschemas = true);
    let schema = inline.into_generator().into_root_schema_for::<Keys>();
    let mut text = String::from(
        "# Every key of quell.toml. A key that is a comment has no default; every table may be left out.\n",
    );
    let tables = schema.get("properties").and_then(Value::as_object);
    for (name, table) in tables.into_iter().flatten() {
        let (each, header, inner) = match table.get("items") {
            Some(items) => ("each ", format!("[[{name}]]"), items),
            None => ("", format!("[{name}]"), some(table)),
        };
        // A table with required keys is absent by default.
        let absent = inner.get("required").is_some();
        let before = if absent { "# " } else { "" };
        let _ = write!(text, "\n{}\n{before}{header}\n", sentence(inner));
        let keys = inner.get("properties").and_then(Value::as_object);
        for (key, value) in keys.into_iter().flatten() {
            let needed = match is_required(inner, key) {
                true => format!(" (needed in {each}{header})"),
                false => String::new(),
            };
            let (what, bounds) = (sentence(value), bounds(key, value));
            let _ = write!(text, "{what}{needed}{}{bounds}", names(value));
            let default = value.get("default").filter(|default| !default.is_null());
            let _ = match default {
                Some(default) => write!(text, "\n{before}{key} = {default}\n"),
                None => write!(text, "\n# {key} =\n"),
            };
        }
    }
    text
}

/// The schema itself, without the option around it.
fn some(schema: &Value) -> &Value {
    let any = schema.get("anyOf").and_then(Value::as_array);
    let some = any.and_then(|any| any.iter().find(|one| one.get("properties").is_some()));
    some.unwrap_or(schema)
}

/// The description, as a comment of one line.
fn sentence(schema: &Value) -> String {
    let words = schema.get("description").and_then(Value::as_str);
    let words: Vec<_> = words.unwrap_or_default().split_whitespace().collect();
    format!("# {}", words.join(" "))
}

/// Whether a table must have a key.
fn is_required(table: &Value, key: &str) -> bool {
    let required = table.get("required").and_then(Value::as_array);
    required.is_some_and(|keys| keys.iter().any(|required| required == key))
}

/// The values of a key, if there is a list of them.
fn names(schema: &Value) -> String {
    let names = schema.get("enum").and_then(Value::as_array);
    let names: Vec<_> = names
        .into_iter()
        .flatten()
        .filter_map(Value::as_str)
        .collect();
    match names.is_empty() {
        true => String::new(),
        false => format!(" One of {}.", names.join(", ")),
    }
}

/// Unit and range of a key, if it has them.
fn bounds(key: &str, schema: &Value) -> String {
    let unit = UNITS.iter().find(|(end, _)| key.ends_with(end));
    let unit = unit.map_or("", |(_, unit)| unit);
    let range = [schema.get("minimum"), schema.get("maximum")];
    match range {
        [Some(low), Some(high)] => format!(" [{low} to {high} {unit}]").replace(" ]", "]"),
        _ if unit.is_empty() => String::new(),
        _ => format!(" [{unit}]"),
    }
}

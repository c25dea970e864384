//! Pieces of a manifest as text: strings, and the table of the layout.

use super::super::layout::Layout;
use std::fmt::Write;

/// The table of the layout; empty for a plain file.
pub fn layout(
    head: &str,
    before: &str,
    layout: &Layout,
    only: Option<(String, String, &str)>,
) -> String {
    let mut text = String::new();
    let mark = |mark: char| quoted(&mark.to_string());
    for (key, value) in [
        ("delimiter", layout.delimiter),
        ("decimal", layout.decimal),
        ("comment", layout.comment),
    ] {
        if let Some(value) = value {
            let _ = writeln!(text, "{key} = {}  # by the form of its lines", mark(value));
        }
    }
    if let Some(skip) = layout.skip {
        let _ = writeln!(text, "skip = {skip}  # lines above the names");
    }
    if layout.header == Some(false) {
        let _ = writeln!(
            text,
            "header = false  # the columns are called \"1\", \"2\", ..."
        );
    }
    if let Some(missing) = &layout.missing {
        let cells: Vec<_> = missing.iter().map(|cell| quoted(cell)).collect();
        let _ = writeln!(
            text,
            "missing = [{}]  # guessed: such cells are samples that are missing",
            cells.join(", ")
        );
    }
    if let Some((column, test, why)) = only {
        let _ = writeln!(
            text,
            "only = {{ {} = {} }}  # guessed: {why}",
            quoted(&column),
            quoted(&test)
        );
    }
    match text.is_empty() {
        true => text,
        false => format!("{before}{head}\n{text}"),
    }
}

/// A TOML string.
pub fn quoted(text: &str) -> String {
    toml::Value::String(text.into()).to_string()
}

/// A text on one line.
pub fn line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}

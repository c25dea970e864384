//! The reference: pages that are made from the code, and never typed.

mod cli;
mod diagnosis;
mod effects;
mod fields;
pub mod http;
mod manifest;
mod methods;
mod model;
mod quell_toml;
mod robot;

use super::{keep, root, tell_stale};

/// Name of the page and what makes it.
type Chapter = (&'static str, fn() -> String);

const CHAPTERS: [Chapter; 9] = [
    ("command-line", cli::page),
    ("diagnosis-json", diagnosis::page),
    ("effects", effects::page),
    ("http", http::page),
    ("manifest", manifest::page),
    ("methods", methods::page),
    ("model", model::page),
    ("quell-toml", quell_toml::page),
    ("robot", robot::page),
];

/// What stands above each page.
pub const MADE: &str = "<!-- Made from the code: QUELL_UPDATE=1 cargo test --release --features full --test book -->\n\n";

#[test]
fn the_reference_is_what_the_code_says() {
    let mut stale = Vec::new();
    let folder = root().join("docs/src/reference");
    for (name, make) in CHAPTERS {
        let file = folder.join(name).with_extension("md");
        keep(&file, &format!("{MADE}{}", make()), &mut stale);
    }
    let schema = folder.join("diagnosis.schema.json");
    keep(&schema, &diagnosis::schema(), &mut stale);
    tell_stale(&stale);
}

/// A table of Markdown.
pub fn table<const N: usize>(
    header: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    let line = |cells: &[String]| {
        let cells = cells
            .iter()
            .map(|cell| cell.replace('\n', " ").replace('|', "\\|"));
        format!("| {} |\n", cells.collect::<Vec<_>>().join(" | "))
    };
    let mut table = line(&header.map(str::to_string));
    table += &format!("|{}\n", "---|".repeat(N));
    for row in rows {
        table += &line(&row);
    }
    table + "\n"
}

/// A comment without the links that only documentation of Rust knows: `[x](y::z)` is `x`.
fn plain(comment: &str) -> String {
    let mut plain = comment.to_string();
    while let Some(middle) = plain
        .match_indices("](")
        .find(|(at, _)| target(&plain[at + 2..]).contains("::"))
    {
        let (middle, end) = (
            middle.0,
            middle.0 + 2 + target(&plain[middle.0 + 2..]).len(),
        );
        let start = plain[..middle].rfind('[').unwrap_or(middle);
        plain.replace_range(middle..=end, "");
        plain.remove(start);
    }
    plain
}

/// A link's target, with the parentheses of a function.
fn target(rest: &str) -> &str {
    let end = rest.find(')').unwrap_or(rest.len());
    match rest[..end].ends_with('(') {
        true => &rest[..(end + 1).min(rest.len())],
        false => &rest[..end],
    }
}

/// Names as code, one behind the other.
pub fn codes<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.into_iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

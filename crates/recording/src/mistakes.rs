//! Mistakes in the syntax of TOML, in plain words.

use std::ops::Range;

/// How the reader's message begins, and what is wrong.
const MISTAKES: [(&str, &str); 15] = [
    (
        "invalid basic string, expected `\"`",
        "the closing \" is missing",
    ),
    (
        "invalid literal string, expected `'`",
        "the closing ' is missing",
    ),
    ("duplicate key", "this key stands a second time"),
    (
        UNQUOTED,
        "a text stands in quotes, and a number has no unit",
    ),
    (
        "invalid boolean",
        "a text stands in quotes, and a number has no unit",
    ),
    ("key with no value", "= is missing behind the key"),
    ("extra `=`", "= stands twice"),
    (
        "invalid mantissa",
        "a number has a digit before its point, as 0.5",
    ),
    (
        "invalid fraction",
        "a number has a digit behind its point, as 8.0",
    ),
    ("unexpected leading zero", "a number does not begin with 0"),
    ("unclosed table", "the closing ] is missing"),
    ("unclosed array table", "the closing ]] is missing"),
    (
        "missing comma between array elements",
        "a comma or the closing ] is missing",
    ),
    (
        "missing comma between key-value pairs",
        "a comma or the closing } is missing",
    ),
    (
        "missing escaped value",
        "in \"...\" a \\ is written \\\\; in '...' it stands alone",
    ),
];
const UNQUOTED: &str = "string values must be quoted";
const FURTHER: &str = "unexpected key or value";

/// What is wrong at a place of a text that is no TOML; the reader's message where it is none of the usual mistakes.
pub fn mistake(text: &str, span: &Range<usize>, message: &str) -> String {
    let there = text.get(span.clone()).unwrap_or_default();
    let [before, behind] =
        [text.get(..span.start), text.get(span.start..)].map(Option::unwrap_or_default);
    let is_boolean = ["true", "false"]
        .iter()
        .any(|own| own.eq_ignore_ascii_case(there));
    let is_header = before
        .rsplit('\n')
        .next()
        .is_some_and(|line| line.starts_with('['));
    let words = match message {
        _ if is_boolean => Some("true and false have small letters"),
        _ if message.starts_with(UNQUOTED) && there.is_empty() => {
            Some("there is no value behind =")
        }
        _ if message.starts_with("duplicate") && is_header => {
            Some("this table stands a second time; those of a list are headed [[...]]")
        }
        _ if message.starts_with(FURTHER) && behind.starts_with(',') => {
            Some("a number has a point, not a comma")
        }
        _ if message.starts_with(FURTHER) => Some("each key stands on a line of its own"),
        _ => {
            let known = MISTAKES.iter().find(|own| message.starts_with(own.0));
            known.map(|own| own.1)
        }
    };
    words.unwrap_or(message).to_owned()
}

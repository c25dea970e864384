//! Errors of a TOML file in one line: the place, the key and its value, and what it must be.

use super::error::{nearest, shortened};
use super::mistakes::mistake;
use super::toml_keys::{TomlKey, column, line, toml_keys};
use std::fmt;
use std::ops::Range;
use toml::de::DeTable;

/// A file that is no TOML, or has an unknown or missing key or one of another type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// Line, counted from 1; none where the whole file is meant.
    pub line: Option<usize>,
    /// Column in it, in characters counted from 1, where the file is no TOML.
    pub column: Option<usize>,
    /// What is wrong there.
    pub reason: String,
}

/// What a value must be, by the name of its type in errors of the reader.
const TYPES: [(&str, &str); 12] = [
    ("f64", "a number"),
    ("f32", "a number"),
    ("u8", "a whole number, 0 or more"),
    ("u16", "a whole number, 0 or more"),
    ("u32", "a whole number, 0 or more"),
    ("u64", "a whole number, 0 or more"),
    ("usize", "a whole number, 0 or more"),
    ("a boolean", "true or false"),
    ("a string", "a text in quotes"),
    ("string or map", "a text in quotes"),
    ("path string", "a text in quotes"),
    ("a map", "a table"),
];

impl SyntaxError {
    /// The error of reading `text`. For a misspelt key or name it suggests the nearest expected one.
    pub fn of(text: &str, error: &toml::de::Error) -> Self {
        let span = error.span();
        let message = error.message().trim().replace('\n', "; ");
        let message = message.replace("missing field", "missing key");
        let broken = span.as_ref().filter(|_| DeTable::parse(text).is_err());
        let reason = match &span {
            Some(span) if broken.is_some() => {
                let what = mistake(text, span, &message);
                format!("{}: {what}", written(text, span.start))
            }
            Some(span) if !message.starts_with("missing key") => at(text, span, &message),
            _ => message,
        };
        Self {
            line: span.as_ref().map(|span| line(text, span.start)),
            column: broken.map(|span| column(text, span.start)),
            reason,
        }
    }
}

/// `:line:column: reason`, to be written behind the name of the file.
impl fmt::Display for SyntaxError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for number in self.line.iter().chain(&self.column) {
            write!(f, ":{number}")?;
        }
        write!(f, ": {}", self.reason)
    }
}

/// The key at a place with its value, and what is wrong with it.
fn at(text: &str, span: &Range<usize>, message: &str) -> String {
    if let Some(unknown) = unknown(message) {
        return unknown;
    }
    let keys = toml_keys(text);
    let holds = |key: &&TomlKey| key.value.start <= span.start && span.end <= key.value.end;
    let key = keys.iter().filter(holds).min_by_key(|key| key.value.len());
    match (key, must_be(message, key)) {
        (Some(key), Some(must)) => format!("{}: it must be {must}", assigned(text, key)),
        (Some(key), None) if key.value == *span => format!("{}: {message}", assigned(text, key)),
        _ => format!("{}: {message}", written(text, span.start)),
    }
}

/// `key = value`, or the key alone where it is a table.
fn assigned(text: &str, key: &TomlKey) -> String {
    let value = text.get(key.value.clone()).unwrap_or_default();
    match key.is_table {
        true => key.path.clone(),
        false => format!("{} = {}", key.path, shortened(value)),
    }
}

/// The line of a byte as it is written, without spaces around it or a comment behind it.
fn written(text: &str, byte: usize) -> String {
    let written = text.lines().nth(line(text, byte) - 1).unwrap_or_default();
    let written = written.split('#').next().unwrap_or_default();
    let parts: Vec<_> = written.splitn(2, '=').map(str::trim).collect();
    shortened(&parts.join(" = "))
}

/// What a value must be, from "invalid type: string "1", expected f64" or "unknown variant `x`, expected one of
/// `a`, `b`".
fn must_be(message: &str, key: Option<&TomlKey>) -> Option<String> {
    if let Some(rest) = message.strip_prefix("unknown variant `") {
        let (name, expected) = rest.split_once('`')?;
        return Some(one_of(name, quoted(expected)));
    }
    let mistyped = ["invalid type: ", "invalid value: ", "invalid length "];
    let rest = mistyped
        .iter()
        .find_map(|start| message.strip_prefix(start))?;
    let (_, expected) = rest.rsplit_once(", expected ")?;
    let known = TYPES.iter().find(|(name, _)| *name == expected);
    Some(match (known, key) {
        (Some((_, words)), _) => (*words).to_owned(),
        (None, Some(key)) if expected == "a sequence" => match key.is_table {
            true => format!("a list of tables, each headed [[{}]]", key.path),
            false => "a list in brackets".to_owned(),
        },
        _ => expected.to_owned(),
    })
}

/// A rule for a value of a list: all of them, and the one that a misspelt value resembles most.
///
/// # Example
/// ```
/// let rule = quell_recording::one_of("upd", ["embedded", "udp"]);
/// assert_eq!(rule, "one of embedded, udp; did you mean \"udp\"?");
/// ```
pub fn one_of<'a>(given: &str, names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<_> = names.into_iter().collect();
    let meant = nearest(given, names.iter().copied());
    let meant = meant.map_or_else(String::new, |name| format!("; did you mean {name:?}?"));
    format!("one of {}{meant}", names.join(", "))
}

/// Serde's "unknown field `x`, expected one of `a`, `b`" with the one that was probably meant, else with all.
fn unknown(message: &str) -> Option<String> {
    let (name, expected) = message.strip_prefix("unknown field `")?.split_once('`')?;
    let expected = quoted(expected);
    let meant = match nearest(name, expected.iter().copied()) {
        Some(nearest) => format!("did you mean {nearest:?}?"),
        None => format!("there are {}", expected.join(", ")),
    };
    Some(format!("unknown key {name:?}; {meant}"))
}

/// The names that stand between back quotes.
pub(super) fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

#[cfg(test)]
mod tests {
    use super::SyntaxError;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Kind {
        Across,
        Ground,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only the errors of reading it are looked at")]
    struct File {
        rate_hz: f64,
        noise_um: Option<f64>,
        #[serde(default)]
        joint: Vec<Joint>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only the errors of reading it are looked at")]
    struct Joint {
        number: Option<usize>,
        kind: Option<Kind>,
    }

    fn refused(text: &str) -> String {
        let error = toml::from_str::<File>(text).unwrap_err();
        SyntaxError::of(text, &error).to_string()
    }

    #[test]
    fn a_misspelt_key_gets_the_nearest_and_a_strange_one_all() {
        let near = ":2: unknown key \"noise_mu\"; did you mean \"noise_um\"?";
        assert_eq!(refused("rate_hz = 1.0\nnoise_mu = 2"), near);
        let strange = ":1: unknown key \"colour\"; there are rate_hz, noise_um, joint";
        assert_eq!(refused("colour = 1"), strange);
    }

    #[test]
    fn a_value_of_another_type_is_named_with_its_key() {
        let joint = |line: &str| refused(&format!("rate_hz = 1\n[[joint]]\n[[joint]]\n{line}\n"));
        for (said, words) in [
            (
                refused("rate_hz = \"1\""),
                ":1: rate_hz = \"1\": it must be a number",
            ),
            (
                refused("rate_hz = 1\n[joint]\nnumber = 1"),
                ":2: joint: it must be a list of tables, each headed [[joint]]",
            ),
            (
                refused("rate_hz = 1\njoint = 3"),
                ":2: joint = 3: it must be a list in brackets",
            ),
            (
                joint("number = -1"),
                ":4: joint[2].number = -1: it must be a whole number, 0 or more",
            ),
            (
                joint("kind = \"acros\""),
                ":4: joint[2].kind = \"acros\": it must be one of across, ground; did you mean \"across\"?",
            ),
        ] {
            assert_eq!(said, words);
        }
    }

    #[test]
    fn what_is_no_toml_is_one_line_with_its_column_and_plain_words() {
        assert!(refused("").ends_with(": missing key `rate_hz`"));
        for (text, words) in [
            (
                "a = \"arm\nb = 2",
                ":1:9: a = \"arm: the closing \" is missing",
            ),
            (
                "a = arm",
                ":1:5: a = arm: a text stands in quotes, and a number has no unit",
            ),
            (
                "a = 8.1 Hz",
                ":1:5: a = 8.1 Hz: a text stands in quotes, and a number has no unit",
            ),
            (
                "a = fast",
                ":1:5: a = fast: a text stands in quotes, and a number has no unit",
            ),
            (
                "a = True",
                ":1:5: a = True: true and false have small letters",
            ),
            ("a =\nb = 1", ":1:4: a = : there is no value behind ="),
            (
                "a = 1\n a = 2",
                ":2:2: a = 2: this key stands a second time",
            ),
            (
                "[a]\n[a]",
                ":2:2: [a]: this table stands a second time; those of a list are headed [[...]]",
            ),
            (
                "a=.05 # low",
                ":1:3: a = .05: a number has a digit before its point, as 0.5",
            ),
            (
                "a = 8.",
                ":1:7: a = 8.: a number has a digit behind its point, as 8.0",
            ),
            (
                "a = 1,5",
                ":1:6: a = 1,5: a number has a point, not a comma",
            ),
            ("a 1", ":1:3: a 1: = is missing behind the key"),
            ("a : 1", ":1:3: a : 1: = is missing behind the key"),
            ("a = = 2", ":1:5: a = = 2: = stands twice"),
            (
                "a = 1 b = 2",
                ":1:9: a = 1 b = 2: each key stands on a line of its own",
            ),
            ("a = 1\n[joint", ":2:7: [joint: the closing ] is missing"),
            ("[[joint]\n", ":1:9: [[joint]: the closing ]] is missing"),
            ("a = [1, 2\nb = 3", "a comma or the closing ] is missing"),
            (
                "a = \"C:\\data\"",
                "in \"...\" a \\ is written \\\\; in '...' it stands alone",
            ),
        ] {
            let said = refused(text);
            assert!(said.contains(words) && !said.contains('\n'), "{said}");
        }
    }
}

//! Errors of a TOML file in one line: the place, the key or value, and a suggestion.

use super::error::nearest;
use std::fmt;

/// A file that is no TOML, or has an unknown or missing key or one of another type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// Line, counted from 1; none where the whole file is meant.
    pub line: Option<usize>,
    /// What is wrong there.
    pub reason: String,
}

impl SyntaxError {
    /// The error of reading `text`. For a misspelt key or name it suggests the nearest expected one.
    pub fn of(text: &str, error: &toml::de::Error) -> Self {
        let span = error.span();
        let line = span.map(|span| {
            let before = text.as_bytes().get(..span.start).unwrap_or(text.as_bytes());
            1 + before.iter().filter(|&&byte| byte == b'\n').count()
        });
        let message = error.message().trim().replace('\n', "; ");
        let message = message.replace("missing field", "missing key");
        let reason = unknown(&message).unwrap_or(message);
        Self { line, reason }
    }
}

/// `:line: reason`, to be written behind the name of the file.
impl fmt::Display for SyntaxError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, ":{line}: {}", self.reason),
            None => write!(f, ": {}", self.reason),
        }
    }
}

/// Serde's "unknown field `x`, expected one of `a`, `b`" with the one that was probably meant, else with all.
fn unknown(message: &str) -> Option<String> {
    let (what, rest) = [("key", "unknown field `"), ("name", "unknown variant `")]
        .into_iter()
        .find_map(|(what, start)| Some((what, message.strip_prefix(start)?)))?;
    let (name, expected) = rest.split_once('`')?;
    let expected: Vec<&str> = expected.split('`').skip(1).step_by(2).collect();
    let meant = match nearest(name, expected.iter().copied()) {
        Some(nearest) => format!("did you mean {nearest:?}?"),
        None => format!("there are {}", expected.join(", ")),
    };
    Some(format!("unknown {what} {name:?}; {meant}"))
}

#[cfg(test)]
mod tests {
    use super::SyntaxError;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only the errors of reading it are looked at")]
    struct File {
        rate_hz: f64,
        noise_um: Option<f64>,
    }

    fn refused(text: &str) -> String {
        let error = toml::from_str::<File>(text).unwrap_err();
        SyntaxError::of(text, &error).to_string()
    }

    #[test]
    fn a_misspelt_key_gets_the_nearest_and_a_strange_one_all() {
        let near = ":2: unknown key \"noise_mu\"; did you mean \"noise_um\"?";
        assert_eq!(refused("rate_hz = 1.0\nnoise_mu = 2"), near);
        let strange = ":1: unknown key \"colour\"; there are rate_hz, noise_um";
        assert_eq!(refused("colour = 1"), strange);
    }

    #[test]
    fn a_wrong_type_a_missing_key_and_no_toml_are_one_line() {
        let wrong = ":1: invalid type: string \"1\", expected f64";
        assert_eq!(refused("rate_hz = \"1\""), wrong);
        assert!(refused("").ends_with(": missing key `rate_hz`"));
        assert!(!refused("rate_hz = = 2").contains('\n'));
    }
}

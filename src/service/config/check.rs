//! Checks of single values of the configuration.

use super::ConfigError;
use crate::recording::{one_of, plain, toml_line};

/// Checks values. Errors name `origin`, and the line of the key in `text`.
#[derive(Clone, Copy)]
pub struct Check<'a> {
    pub origin: &'a str,
    pub text: &'a str,
}

impl<'a> Check<'a> {
    /// Checks values that no file has.
    pub fn of(origin: &'a str) -> Self {
        Self { origin, text: "" }
    }

    /// The value of an option where it is given, else that of the file, and where it is from.
    pub fn over<T>(&self, option: Option<T>, key: T) -> (Self, T) {
        match option {
            Some(value) => (Self::of("command line"), value),
            None => (*self, key),
        }
    }

    /// The error of a value that is not as expected.
    pub fn refuse(
        &self,
        key: &str,
        value: impl std::fmt::Display,
        expected: impl Into<String>,
    ) -> ConfigError {
        let line = toml_line(self.text, key).map(|line| format!(":{line}"));
        ConfigError::Value {
            origin: format!("{}{}", self.origin, line.unwrap_or_default()),
            key: key.to_owned(),
            value: value.to_string(),
            expected: expected.into(),
        }
    }

    /// The error of a name that is none of a list.
    pub fn unknown(
        &self,
        key: &str,
        name: &str,
        names: impl IntoIterator<Item = &'static str>,
    ) -> ConfigError {
        self.refuse(key, format!("{name:?}"), one_of(name, names))
    }

    /// A value above 0, at most the last one.
    pub fn positive(&self, key: &str, value: f64, most: f64) -> Result<f64, ConfigError> {
        match value > 0.0 && value <= most {
            true => Ok(value),
            false => Err(self.refuse(key, plain(value), format!("above 0 and at most {most:e}"))),
        }
    }

    /// A value of a range.
    pub fn within(&self, key: &str, value: f64, [low, high]: [f64; 2]) -> Result<f64, ConfigError> {
        match (low..=high).contains(&value) {
            true => Ok(value),
            false => Err(self.refuse(key, plain(value), format!("from {low} to {high}"))),
        }
    }
}

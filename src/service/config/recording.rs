//! `[recording]`: moves on disk.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Deserialize;

use super::{Check, ConfigError};

/// `[recording]`: moves on disk.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RecordingKeys {
    /// Whether every move is recorded.
    pub enabled: bool,
    /// Whether a move is refused while nothing can be recorded.
    pub required: bool,
    /// Most bytes of all recordings, MB; the oldest go first.
    #[schemars(range(min = 1.0, max = 1e9))]
    pub max_size_mb: f64,
    /// Most recordings; the oldest go first.
    #[schemars(range(min = 1, max = 1000000))]
    pub max_count: usize,
    /// So many of the last ones never go, however large they are.
    pub keep_last: usize,
    /// Retired: a clock that jumps changes every age.
    #[schemars(skip)]
    pub max_age_days: Option<f64>,
}

impl Default for RecordingKeys {
    fn default() -> Self {
        Self {
            enabled: true,
            required: false,
            max_size_mb: 1000.0,
            max_count: 10_000,
            keep_last: 10,
            max_age_days: None,
        }
    }
}

/// Moves on disk.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingConfig {
    /// Whether every move is recorded.
    pub enabled: bool,
    /// Whether a move is refused while nothing can be recorded.
    pub required: bool,
    /// Their folder.
    pub folder: PathBuf,
    /// Most bytes of all of them; the oldest go first.
    pub max_bytes: u64,
    /// Most of them; the oldest go first.
    pub max_count: usize,
    /// So many of the last ones never go, at least one.
    pub keep_last: usize,
}

impl RecordingKeys {
    /// The keys, checked, for a data folder.
    ///
    /// # Errors
    /// [`ConfigError::Value`] with the key.
    pub(super) fn checked(
        &self,
        data: &Path,
        check: &Check,
    ) -> Result<RecordingConfig, ConfigError> {
        if let Some(days) = self.max_age_days {
            return Err(check.refuse(
                "recording.max_age_days",
                days,
                "left out: a clock that jumps changes every age. Recordings go in the order in which \
                 they were made, by recording.max_size_mb and recording.max_count, and never the last \
                 recording.keep_last",
            ));
        }
        if self.required && !self.enabled {
            let expected = "false where recording.enabled is false";
            return Err(check.refuse("recording.required", true, expected));
        }
        let megabytes = check.within("recording.max_size_mb", self.max_size_mb, [1.0, 1e9])?;
        let count = self.max_count as f64;
        check.within("recording.max_count", count, [1.0, 1e6])?;
        // The newest always stays: otherwise it would be removed as soon as it was made.
        check.within("recording.keep_last", self.keep_last as f64, [1.0, count])?;
        Ok(RecordingConfig {
            enabled: self.enabled,
            required: self.required,
            folder: data.join("recordings"),
            max_bytes: (megabytes * 1e6) as u64,
            max_count: self.max_count,
            keep_last: self.keep_last,
        })
    }
}

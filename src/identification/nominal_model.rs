//! The nominal model of a joint, as a file: what the engineer believes.

use std::path::{Path, PathBuf};

use quell_shapers::Mode;

/// A flexible joint driven by its motor side, as its file says.
///
/// ```toml
/// kind = "flexible_joint"
/// natural_frequency_hz = 8.207
/// damping_ratio = 0.059
/// lever_arm_m = 1.8      # optional, needed for a tip sensor
/// tip_height_m = 0.9     # optional, 0
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NominalModel {
    /// The believed mode.
    pub mode: Mode,
    /// Distance of the tip from the joint's axis, m.
    pub lever_arm: Option<f64>,
    /// Height of the tip above the base frame's origin, m.
    pub tip_height: f64,
}

/// Why a model file was refused.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file cannot be read.
    #[error("cannot read the model {}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is no TOML, or a key is missing, unknown or of the wrong type.
    #[error("{}:{line}: {reason}", file.display())]
    Parse {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
    /// A value is out of its range.
    #[error("{}: {key} = {value}: {reason}", file.display())]
    Value {
        /// The file.
        file: PathBuf,
        /// The key.
        key: &'static str,
        /// The value.
        value: String,
        /// What it should be.
        reason: String,
    },
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    kind: String,
    natural_frequency_hz: f64,
    damping_ratio: f64,
    lever_arm_m: Option<f64>,
    tip_height_m: Option<f64>,
}

impl NominalModel {
    /// Reads the file.
    ///
    /// # Errors
    /// [`ModelError`] with the file and the line or key.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, ModelError> {
        let file = path.as_ref().to_path_buf();
        let text = std::fs::read_to_string(&file).map_err(|source| ModelError::Read {
            file: file.clone(),
            source,
        })?;
        let model: File = toml::from_str(&text).map_err(|error| {
            let start = error.span().map_or(0, |span| span.start.min(text.len()));
            ModelError::Parse {
                file: file.clone(),
                line: 1 + text.as_bytes()[..start]
                    .iter()
                    .filter(|&&b| b == b'\n')
                    .count(),
                reason: error.message().to_string(),
            }
        })?;
        let refuse = |key, value: String, reason: &str| {
            Err(ModelError::Value {
                file: file.clone(),
                key,
                value,
                reason: reason.to_string(),
            })
        };
        if model.kind != "flexible_joint" {
            return refuse(
                "kind",
                format!("\"{}\"", model.kind),
                "known: \"flexible_joint\"",
            );
        }
        for (key, value) in [
            ("lever_arm_m", model.lever_arm_m),
            ("tip_height_m", model.tip_height_m),
        ] {
            if let Some(value) =
                value.filter(|v| !v.is_finite() || (key == "lever_arm_m" && *v <= 0.0))
            {
                return refuse(
                    key,
                    value.to_string(),
                    "a finite length, the lever arm above 0",
                );
            }
        }
        let mode = match Mode::from_hertz(model.natural_frequency_hz, model.damping_ratio) {
            Ok(mode) => mode,
            Err(error) => {
                let value = format!(
                    "{}, damping_ratio = {}",
                    model.natural_frequency_hz, model.damping_ratio
                );
                return refuse("natural_frequency_hz", value, &error.to_string());
            }
        };
        Ok(Self {
            mode,
            lever_arm: model.lever_arm_m,
            tip_height: model.tip_height_m.unwrap_or(0.0),
        })
    }
}

//! The nominal model of a joint, as a file: the engineer's belief.

use std::path::Path;

use quell_shapers::Mode;

use quell_model::{Model, ModelError};

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

impl NominalModel {
    /// Reads the file.
    ///
    /// # Errors
    /// [`ModelError`] with the file, the line and the key.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, ModelError> {
        let file = path.as_ref();
        Self::of(&Model::from_path(file)?, file)
    }

    /// The nominal part of a model; errors name the file.
    ///
    /// # Errors
    /// [`ModelError`] where it is of another kind.
    pub fn of(model: &Model, file: &Path) -> Result<Self, ModelError> {
        let refuse = |key: &str, reason: String| ModelError::Key {
            file: file.to_path_buf(),
            line: 1,
            key: key.into(),
            reason,
        };
        let believed = match model.kind.name {
            "flexible_joint" => model.kind.mode,
            _ => None,
        };
        let Some((frequency, damping)) = believed else {
            let reason = format!("\"{}\": a flexible_joint is wanted here", model.kind.name);
            return Err(refuse("kind", reason));
        };
        let mode = Mode::from_hertz(model.values[frequency].value, model.values[damping].value)
            .map_err(|error| refuse("natural_frequency_hz", error.to_string()))?;
        Ok(Self {
            mode,
            lever_arm: model.given("lever_arm_m"),
            tip_height: model.given("tip_height_m").unwrap_or(0.0),
        })
    }
}

//! Checks of single values; a refusal names file, key and value.

use std::path::Path;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};

use crate::plant::RobotError;
use quell_recording::toml_line;

/// Highest rate of a controller, sensor or mode, Hz, so that a simulation ends.
const HIGHEST_RATE: f64 = 1e6;

/// Checks values; `file` and the line in `text` are in errors.
pub struct Check<'a> {
    pub file: &'a Path,
    pub text: &'a str,
}

impl Check<'_> {
    pub fn refuse(
        &self,
        key: &str,
        value: impl std::fmt::Display,
        expected: &'static str,
    ) -> RobotError {
        let value = value.to_string();
        RobotError::Value {
            file: self.file.to_path_buf(),
            line: toml_line(self.text, key),
            key: key.to_string(),
            value,
            expected,
        }
    }

    pub fn finite(&self, key: &str, value: f64) -> Result<f64, RobotError> {
        if value.is_finite() {
            Ok(value)
        } else {
            Err(self.refuse(key, value, "a finite number"))
        }
    }

    pub fn positive(&self, key: &str, value: f64) -> Result<f64, RobotError> {
        let holds = value.is_finite() && value > 0.0;
        if holds {
            Ok(value)
        } else {
            Err(self.refuse(key, value, "a finite number above 0"))
        }
    }

    /// A rate or a frequency, Hz.
    pub fn rate(&self, key: &str, value: f64) -> Result<f64, RobotError> {
        if value > 0.0 && value <= HIGHEST_RATE {
            Ok(value)
        } else {
            Err(self.refuse(key, value, "above 0 Hz and at most 1e6 Hz"))
        }
    }

    pub fn not_negative(&self, key: &str, value: f64) -> Result<f64, RobotError> {
        let holds = value.is_finite() && value >= 0.0;
        if holds {
            Ok(value)
        } else {
            Err(self.refuse(key, value, "a finite number, 0 or more"))
        }
    }

    pub fn pose(
        &self,
        at: &str,
        position: [f64; 3],
        rpy_deg: [f64; 3],
    ) -> Result<Isometry3<f64>, RobotError> {
        for value in position {
            self.finite(&format!("{at}.position_m"), value)?;
        }
        for value in rpy_deg {
            self.finite(&format!("{at}.rpy_deg"), value)?;
        }
        let [roll, pitch, yaw] = rpy_deg.map(f64::to_radians);
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        Ok(Isometry3::from_parts(
            Translation3::from(Vector3::from(position)),
            rotation,
        ))
    }
}

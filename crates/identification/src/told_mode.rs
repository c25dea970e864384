//! Modes of a joint with what is known of each.

use super::NominalModel;
use quell_model::effects::{Law, Resonance};
use quell_model::{Model, ModelEffect, ModelError};
use quell_shapers::{Mode, UncertainMode};
use std::path::Path;

const TAU: f64 = core::f64::consts::TAU;

/// A mode, and how well it is known where its source says so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToldMode {
    /// The mode.
    pub mode: Mode,
    /// One standard deviation of the natural frequency, rad/s.
    pub natural_frequency_std: Option<f64>,
    /// One standard deviation of the damping ratio.
    pub damping_ratio_std: Option<f64>,
}

impl From<Mode> for ToldMode {
    fn from(mode: Mode) -> Self {
        Self {
            mode,
            natural_frequency_std: None,
            damping_ratio_std: None,
        }
    }
}

impl From<UncertainMode> for ToldMode {
    fn from(known: UncertainMode) -> Self {
        let told = |std: f64| (std.is_finite() && std > 0.0).then_some(std);
        Self {
            mode: known.mode,
            natural_frequency_std: told(known.natural_frequency_std),
            damping_ratio_std: told(known.damping_ratio_std),
        }
    }
}

impl ToldMode {
    /// The modes of a model file: that of its joint, then one for each effect that is a further mode.
    ///
    /// # Errors
    /// [`ModelError`] with the file, the line and the key.
    pub fn of_model(file: &Path) -> Result<Vec<Self>, ModelError> {
        let model = Model::from_path(file)?;
        let first = NominalModel::of(&model, file)?.mode;
        let std = |key: &str| {
            let place = model.kind.keys.iter().position(|own| own.name == key)?;
            model.values[place].std
        };
        let mut modes = vec![Self {
            mode: first,
            natural_frequency_std: std("natural_frequency_hz").map(|hertz| TAU * hertz),
            damping_ratio_std: std("damping_ratio"),
        }];
        for effect in &model.effects {
            modes.extend(Self::of_effect(effect, file)?);
        }
        Ok(modes)
    }

    /// The mode of an effect; `None` where it is none, or its share is the neutral 0.
    fn of_effect(own: &ModelEffect, file: &Path) -> Result<Option<Self>, ModelError> {
        let values: Vec<f64> = own.parameters.iter().map(|value| value.value).collect();
        let Law::Resonance(resonance) = (own.effect.law)(&values) else {
            return Ok(None);
        };
        let Resonance {
            natural_frequency,
            damping_ratio,
            share,
            ..
        } = resonance;
        if share == 0.0 {
            return Ok(None);
        }
        let std = |name: &str| {
            let mut names = own.effect.parameters.iter();
            let place = names.position(|parameter| parameter.name == name)?;
            own.parameters.get(place)?.std
        };
        let mode =
            Mode::new(natural_frequency, damping_ratio).map_err(|error| ModelError::Key {
                file: file.to_path_buf(),
                line: 1,
                key: own.effect.name.into(),
                reason: error.to_string(),
            })?;
        Ok(Some(Self {
            mode,
            natural_frequency_std: std("natural_frequency"),
            damping_ratio_std: std("damping_ratio"),
        }))
    }

    /// The mode, as uncertain as a believed one where its source tells nothing.
    pub fn or_believed(&self) -> UncertainMode {
        let believed = UncertainMode::believed(self.mode);
        self.or(believed.natural_frequency_std, believed.damping_ratio_std)
    }

    /// The mode, with these standard deviations (rad/s and of the ratio) where its source tells none.
    pub fn or(&self, natural_frequency_std: f64, damping_ratio_std: f64) -> UncertainMode {
        UncertainMode {
            mode: self.mode,
            natural_frequency_std: self.natural_frequency_std.unwrap_or(natural_frequency_std),
            damping_ratio_std: self.damping_ratio_std.unwrap_or(damping_ratio_std),
        }
    }
}

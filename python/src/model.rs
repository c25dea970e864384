//! Models.

use super::errors;
use pyo3::prelude::*;
use quell::model;
use std::path::PathBuf;

/// Name and place of an effect, and its parameters.
type Line = (&'static str, &'static str, Vec<(&'static str, f64)>);

/// A model of an axis.
#[pyclass(frozen, module = "quell._quell")]
pub struct Model {
    pub model: model::Model,
    /// Its file, as errors and reports call it.
    pub file: PathBuf,
}

#[pymethods]
impl Model {
    /// Of the text of a `model.toml`, which errors call by the name of `file`.
    #[new]
    fn new(text: &str, file: PathBuf) -> PyResult<Self> {
        let model = model::Model::from_toml(text, &file).map_err(errors::model)?;
        Ok(Self { model, file })
    }

    /// Reads a `model.toml`.
    #[staticmethod]
    fn load(file: PathBuf) -> PyResult<Self> {
        let model = model::Model::from_path(&file).map_err(errors::model)?;
        Ok(Self { model, file })
    }

    /// The text of its `model.toml`.
    fn toml(&self) -> String {
        self.model.to_toml()
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.model.kind.name
    }

    #[getter]
    fn file(&self) -> PathBuf {
        self.file.clone()
    }

    /// Names of its keys and their values.
    fn values(&self) -> Vec<(&'static str, f64)> {
        let names = self.model.kind.keys.iter().map(|key| key.name);
        names
            .zip(self.model.values.iter().map(|value| value.value))
            .collect()
    }

    /// Name, place and parameters of each of its effects.
    fn effects(&self) -> Vec<Line> {
        let line = |one: &model::ModelEffect| {
            let names = one.effect.parameters.iter().map(|parameter| parameter.name);
            let values = one.parameters.iter().map(|value| value.value);
            (
                one.effect.name,
                one.place.name(),
                names.zip(values).collect(),
            )
        };
        self.model.effects.iter().map(line).collect()
    }
}

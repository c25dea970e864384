//! Modes of recordings.

use super::errors;
use super::model::Model;
use super::recording::Recording;
use super::waiting::{Watch, wait};
use pyo3::prelude::*;
use quell::cli::identify::Identified;
use quell::identification::NominalModel;
use quell::signal::TipRegistration;
use std::path::PathBuf;

/// JSON, text, HTML, and the text of a model.
type Told = (String, String, String, Option<String>);

/// What is identified in recordings, each of a file that may be none (empty).
#[pyfunction]
pub fn identify(
    py: Python<'_>,
    recordings: Vec<(PathBuf, PyRef<'_, Recording>)>,
    model: Option<&Model>,
    registration: &str,
) -> PyResult<Told> {
    let believed = model.map(|given| NominalModel::of(&given.model, &given.file));
    let believed = believed.transpose().map_err(errors::model)?;
    let way = TipRegistration::ALL
        .iter()
        .find(|way| way.name() == registration);
    let Some(&way) = way else {
        let names: Vec<_> = TipRegistration::ALL.iter().map(|way| way.name()).collect();
        let text = format!(
            "registration \"{registration}\": it is one of {}",
            names.join(", ")
        );
        return Err(errors::identification(&quell::cli::CliError::input(text)));
    };
    let recordings = recordings
        .into_iter()
        .map(|(path, one)| (path, one.0.clone()));
    let recordings: Vec<_> = recordings.collect();
    let watch = Watch::default();
    let asked = watch.clone();
    let told = wait(py, &watch, None, move || {
        let stop = || asked.stops();
        let found = Identified::of(recordings, believed.as_ref(), way, &stop)?;
        let document = found.document().to_string();
        Ok((
            document,
            found.text(),
            found.page().render(),
            found.models().into_iter().next().flatten(),
        ))
    })?;
    told.map_err(|error| errors::identification(&error))
}

//! Errors as exceptions of `quell.errors`, with the message that the command line prints and the place as attributes.

use pyo3::{PyErr, import_exception};
use quell::cli::CliError;
use quell::diagnosis::DiagnosisError;
use quell::model::ModelError;
use quell::recording;
use quell::shapers;
use quell::signal::SignalError;
use quell::trajectories::PlanError;
use std::error::Error;

/// The classes of the package.
mod classes {
    use super::import_exception;
    import_exception!(quell.errors, DiagnosisError);
    import_exception!(quell.errors, IdentificationError);
    import_exception!(quell.errors, ModelError);
    import_exception!(quell.errors, PlanError);
    import_exception!(quell.errors, RecordingError);
    import_exception!(quell.errors, ShaperError);
    import_exception!(quell.errors, SimulationError);
}

/// The message of the command line, without the word `error`.
fn told(error: &CliError) -> String {
    let text = error.told();
    text.trim_start_matches("error: ").trim_end().to_string()
}

/// The same of an error that the command line calls bad input.
fn input(error: impl Error + Send + Sync + 'static) -> String {
    told(&CliError::input(error))
}

/// A recording that is refused: file, line, column, byte, topic and field.
pub fn recording(error: recording::RecordingError) -> PyErr {
    let place = error.place.clone();
    let file = (!place.file.as_os_str().is_empty()).then(|| place.file.display().to_string());
    let message = told(&error.into());
    classes::RecordingError::new_err((
        message,
        file,
        place.line,
        place.column,
        place.byte,
        place.topic,
        place.field,
    ))
}

/// Positions that are no motion.
pub fn course(error: SignalError) -> PyErr {
    classes::RecordingError::new_err((input(error),))
}

/// A model that is refused: file, line and key.
pub fn model(error: ModelError) -> PyErr {
    let (file, line, key) = match &error {
        ModelError::Read { file, .. } => (file, None, None),
        ModelError::Syntax { file, line, .. } => (file, Some(*line), None),
        ModelError::Key {
            file, line, key, ..
        } => (file, Some(*line), Some(key.clone())),
    };
    let file = file.display().to_string();
    classes::ModelError::new_err((input(error), file, line, key))
}

/// A recording in which nothing can be identified.
pub fn identification(error: &CliError) -> PyErr {
    classes::IdentificationError::new_err((told(error),))
}

/// A robot or a command that cannot be simulated.
pub fn simulation(error: &CliError) -> PyErr {
    classes::SimulationError::new_err((told(error),))
}

/// A diagnosis or prediction that cannot be made.
pub fn diagnosis(error: DiagnosisError) -> PyErr {
    classes::DiagnosisError::new_err((input(error),))
}

/// A shaper that cannot be designed or run.
pub fn shaper(error: impl Error + Send + Sync + 'static) -> PyErr {
    classes::ShaperError::new_err((input(error),))
}

/// A shaper of a name that is not in the table.
pub fn no_shaper(name: &str) -> PyErr {
    let names: Vec<_> = shapers::SHAPERS
        .iter()
        .map(|shaper| shaper.name())
        .collect();
    let nearest = recording::nearest(name, names.iter().copied());
    let meant = nearest.map_or(String::new(), |name| format!("; did you mean \"{name}\"?"));
    let text = format!(
        "unknown shaper \"{name}\"{meant} (there are {})",
        names.join(", ")
    );
    classes::ShaperError::new_err((text,))
}

/// A move that cannot be planned.
pub fn plan(error: PlanError) -> PyErr {
    classes::PlanError::new_err((input(error),))
}

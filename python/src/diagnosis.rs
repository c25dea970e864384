//! Diagnosis, prediction and score.

use super::errors;
use super::model::Model;
use super::recording::Recording;
use super::waiting::{Watch, wait};
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use quell::diagnosis::{self, DiagnosisError, Options, Outcome, OutputTrace, Stop};
use quell::recording;
use quell::report::{Case, judgement_lines, page, score_line, text};
use rayon::ThreadPoolBuilder;
use std::num::NonZeroUsize;
use std::time::{Duration, Instant};

type Array<'py> = Bound<'py, PyArray1<f64>>;
/// Name, unit, stamps, what was recorded, before and after, the noise's standard deviation.
type Traced<'py> = (String, String, [Array<'py>; 4], f64);
/// JSON, text, HTML, the text of the better model, what is drawn.
type Told<'py> = (String, String, String, String, Vec<Traced<'py>>);
/// Role, unit, stamps, what was recorded, what is predicted.
type Predicted<'py> = (&'static str, String, [Array<'py>; 3]);

/// Diagnoses a model; `limits` are the time for the search, s, and the number of threads.
#[pyfunction]
pub fn diagnose<'py>(
    py: Python<'py>,
    model: &Model,
    recordings: (Vec<PyRef<'_, Recording>>, Vec<PyRef<'_, Recording>>),
    seed: u64,
    limits: (Option<f64>, Option<usize>),
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Told<'py>> {
    let taken = |all: Vec<PyRef<'_, Recording>>| -> Vec<_> {
        all.iter().map(|one| one.0.clone()).collect()
    };
    let (train, held_out) = (taken(recordings.0), taken(recordings.1));
    let names = train
        .iter()
        .chain(&held_out)
        .map(|one| one.name.clone())
        .collect();
    let called = model.file.display().to_string();
    let (model, watch) = (model.model.clone(), Watch::default());
    let pool = limits
        .1
        .map(|threads| ThreadPoolBuilder::new().num_threads(threads).build());
    let pool = pool
        .transpose()
        .map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let own = watch.clone();
    let work = move || -> Result<_, DiagnosisError> {
        let (stop, tell) = (own.clone(), own);
        let start = Instant::now();
        let enough = |limit: f64| {
            let limit = Duration::try_from_secs_f64(limit).unwrap_or(Duration::MAX);
            Stop::when(move || start.elapsed() > limit)
        };
        let options = Options {
            seed,
            stop: Stop::when(move || stop.stops()),
            enough: limits.0.map_or_else(Stop::default, enough),
            ..Options::default()
        };
        let told = |share: f64, what: &str| tell.tell(share, what);
        let work = || diagnosis::diagnose(&model, &train, &held_out, &options, &told);
        let outcome = match &pool {
            Some(pool) => pool.install(work),
            None => work(),
        }?;
        Ok(written(outcome, &called, names, seed))
    };
    let (document, words, html, toml, outputs) =
        wait(py, &watch, progress, work)?.map_err(errors::diagnosis)?;
    let traced = |one: OutputTrace| {
        let arrays = [one.time, one.recorded, one.before, one.after];
        let arrays = arrays.map(|values| values.into_pyarray(py));
        (one.name, one.unit, arrays, one.noise_std)
    };
    let outputs = outputs.into_iter().map(traced).collect();
    Ok((document, words, html, toml, outputs))
}

/// What a diagnosis gives, in every form.
fn written(
    outcome: Outcome,
    model: &str,
    names: Vec<String>,
    seed: u64,
) -> (String, String, String, String, Vec<OutputTrace>) {
    let (diagnosis, traces) = (&outcome.diagnosis, &outcome.traces);
    // Every number was checked to be finite, so that it can be written.
    let document = serde_json::to_string(diagnosis).unwrap_or_default();
    let words = text(&Case::new(diagnosis, traces), &[]);
    let page = page(diagnosis, traces, model, &names);
    let html = page
        .footnote(format!("quell.diagnose, seed {seed}"))
        .render();
    let toml = outcome.to_toml();
    (document, words, html, toml, outcome.traces.outputs)
}

/// Predicts a recording: each output, the score as JSON and in a line.
#[pyfunction]
pub fn predict<'py>(
    py: Python<'py>,
    model: &Model,
    recording: &Recording,
    first: Option<NonZeroUsize>,
) -> PyResult<(Vec<Predicted<'py>>, String, String)> {
    let (model, recording): (_, recording::Recording) = (model.model.clone(), recording.0.clone());
    let predicted = wait(py, &Watch::default(), None, move || match first {
        Some(samples) => diagnosis::forecast(&model, recording, samples),
        None => diagnosis::predict(&model, recording),
    })?;
    let (outputs, score) = predicted.map_err(errors::diagnosis)?;
    let document = serde_json::to_string(&score).unwrap_or_default();
    let output = |one: diagnosis::Predicted| {
        let arrays = [one.time, one.recorded, one.predicted];
        (
            one.name,
            one.unit,
            arrays.map(|values| values.into_pyarray(py)),
        )
    };
    let line = score_line(&score);
    Ok((outputs.into_iter().map(output).collect(), document, line))
}

/// Scores a model on a recording: as JSON, in lines, and the line with its payload if it names one.
#[pyfunction]
pub fn score(
    py: Python<'_>,
    model: &Model,
    recording: &Recording,
    first: Option<NonZeroUsize>,
) -> PyResult<(String, String, Option<String>)> {
    let (model, recording): (_, recording::Recording) = (model.model.clone(), recording.0.clone());
    let judgement = wait(py, &Watch::default(), None, move || {
        diagnosis::judge(&model, recording, first)
    })?;
    let judgement = judgement.map_err(errors::diagnosis)?;
    let document = serde_json::to_string(&judgement).unwrap_or_default();
    let own = judgement.with_payload.as_ref();
    let own = own.map(|carried| score_line(&carried.score));
    Ok((document, judgement_lines(&judgement), own))
}

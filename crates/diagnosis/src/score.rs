//! How well a model predicts a recording that it has never seen.

use super::baseline::problem;
use super::error::DiagnosisError;
use super::excitation::{Carried, carried};
use super::fit::Projector;
use super::split;
use super::start::ringing;
use super::weights::measure_noise;
use quell_model::{Experiment, Model, Output, Term};
use quell_recording::Recording;
use serde::{Deserialize, Serialize};

/// The error of a prediction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// Root mean square error of the first output, in `unit`.
    pub rms: f64,
    /// Its unit.
    pub unit: String,
    /// Standard deviation of the noise.
    pub noise_std: f64,
    /// The former over the latter.
    pub rms_over_noise: f64,
    /// `100 (1 - |error| / |recorded - mean|)`, percent; of a joint's link position, whose deformation is what
    /// the model is about, that of the deformation.
    pub fit_percent: f64,
}

/// A prediction of every output, and the recording, at its stamps.
pub struct Predicted {
    /// Role of the channel.
    pub name: &'static str,
    /// Unit.
    pub unit: String,
    /// Stamps, s.
    pub time: Vec<f64>,
    /// What was recorded.
    pub recorded: Vec<f64>,
    /// What the model says.
    pub predicted: Vec<f64>,
}

/// Predicts a recording; only clocks, offsets, frames and unknown starts are fitted.
///
/// The recording is taken, and the motion is simulated part by part: memory and time go with the number of
/// samples, some hundred bytes each.
///
/// # Errors
/// [`DiagnosisError`] where the recording does not suit the model.
pub fn predict(
    model: &Model,
    recording: Recording,
) -> Result<(Vec<Predicted>, Score), DiagnosisError> {
    predict_with(model, &[], recording, 0)
}

/// [`predict`] with what happened in a set of recordings, of which this is the one of an index.
fn predict_with(
    model: &Model,
    happened: &[Term],
    recording: Recording,
    index: usize,
) -> Result<(Vec<Predicted>, Score), DiagnosisError> {
    if let Carried::Nothing(words) = carried(model, std::slice::from_ref(&recording))? {
        let recording = recording.name;
        return Err(DiagnosisError::Still { recording, words });
    }
    let name = recording.name.clone();
    let mut experiments = vec![Experiment::of(model, recording)?];
    experiments[0].recording = index;
    let (residuals, noise) = left(model, happened, &experiments);
    let score = score_of(&experiments[0], &residuals[0], noise);
    let numbers = [
        score.rms,
        score.noise_std,
        score.rms_over_noise,
        score.fit_percent,
    ];
    if numbers.iter().any(|number| !number.is_finite()) {
        return Err(DiagnosisError::RunsAway { recording: name });
    }
    let outputs = experiments.swap_remove(0).outputs;
    let pairs = outputs.into_iter().zip(residuals);
    Ok((pairs.map(|(o, r)| Predicted::new(o, r)).collect(), score))
}

/// What the model leaves of each output, and the first one's noise.
fn left(model: &Model, happened: &[Term], experiments: &[Experiment]) -> (Vec<Vec<f64>>, f64) {
    let rows = experiments.iter().map(split::whole).collect();
    let mut fit = problem(model, experiments, rows);
    fit.freeze();
    let mut start = fit.start(model);
    start.terms.extend_from_slice(happened);
    start.given_terms = start.terms.len();
    let mut projector = Projector::new(&fit);
    let still = fit.fit(&start, &projector, 15);
    let first = ringing(&mut fit, still, &projector);
    measure_noise(&mut fit, &first.point);
    projector = Projector::new(&fit);
    let fitted = fit.fit(&first.point, &projector, 15);
    drop(projector);
    let noise = fit.noise[0][0].deviation;
    (fit.explained(&fitted.point, 0), noise)
}

impl Predicted {
    /// Of an output, and what the model leaves of it.
    fn new(output: Output, mut residual: Vec<f64>) -> Self {
        let Output {
            scale, mut values, ..
        } = output;
        for (y, r) in values.iter_mut().zip(&mut residual) {
            *r = (*y - *r) * scale;
            *y *= scale;
        }
        Self {
            name: output.channel.name(),
            unit: output.unit,
            time: output.time,
            recorded: values,
            predicted: residual,
        }
    }
}

/// [`predict`]'s score.
///
/// # Errors
/// As [`predict`].
pub fn score(model: &Model, recording: &Recording) -> Result<Score, DiagnosisError> {
    Ok(predict(model, recording.clone())?.1)
}

/// [`score`] with what happened in a set of recordings, of which this is the one of an index.
///
/// # Errors
/// As [`predict`].
pub fn score_with(
    model: &Model,
    happened: &[Term],
    recording: Recording,
    index: usize,
) -> Result<Score, DiagnosisError> {
    Ok(predict_with(model, happened, recording, index)?.1)
}

fn score_of(experiment: &Experiment, residual: &[f64], deviation: f64) -> Score {
    let output = &experiment.outputs[0];
    let n = residual.len() as f64;
    let square: f64 = residual.iter().map(|r| r * r).sum();
    let shown = super::draw::shown(experiment, output);
    let mean = shown.iter().sum::<f64>() / n;
    let spread: f64 = shown.iter().map(|y| (y - mean).powi(2)).sum();
    Score {
        rms: (square / n).sqrt() * output.scale,
        unit: output.unit.clone(),
        noise_std: deviation * output.scale,
        rms_over_noise: (square / n).sqrt() / deviation,
        fit_percent: 100.0 * (1.0 - (square / spread).sqrt()),
    }
}

//! How well a model predicts a recording that it has never seen.

use super::baseline::{DiagnosisError, problem};
use super::fit::Projector;
use super::split;
use super::start::ringing;
use super::weights::measure_noise;
use crate::model::{Experiment, Model};
use crate::recording::Recording;
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
/// # Errors
/// [`DiagnosisError`] where the recording does not suit the model.
pub fn predict(
    model: &Model,
    recording: &Recording,
) -> Result<(Vec<Predicted>, Score), DiagnosisError> {
    let experiments = vec![Experiment::new(model, recording)?];
    let rows = experiments.iter().map(split::whole).collect();
    let mut fit = problem(model, &experiments, rows);
    fit.freeze();
    let start = fit.start(model);
    let mut projector = Projector::new(&fit);
    let still = fit.fit(&start, &projector, 15);
    let first = ringing(&mut fit, still, &projector);
    measure_noise(&mut fit, &first.point);
    projector = Projector::new(&fit);
    let fitted = fit.fit(&first.point, &projector, 15);
    let residual = fit.explained(&fitted.point, 0);
    let mut outputs = Vec::new();
    for (output, residual) in experiments[0].outputs.iter().zip(&residual) {
        let values = output.values.iter();
        outputs.push(Predicted {
            name: output.channel.name(),
            unit: output.unit.clone(),
            time: output.time.clone(),
            recorded: values.clone().map(|y| y * output.scale).collect(),
            predicted: values
                .zip(residual)
                .map(|(y, r)| (y - r) * output.scale)
                .collect(),
        });
    }
    let score = score_of(&experiments[0], &residual[0], fit.noise[0][0].deviation);
    if !score.rms.is_finite() {
        let recording = recording.name.clone();
        return Err(DiagnosisError::RunsAway { recording });
    }
    Ok((outputs, score))
}

/// [`predict`]'s score.
///
/// # Errors
/// As [`predict`].
pub fn score(model: &Model, recording: &Recording) -> Result<Score, DiagnosisError> {
    Ok(predict(model, recording)?.1)
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

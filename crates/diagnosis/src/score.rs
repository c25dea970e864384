//! How well a model predicts a recording that it has never seen.

use super::baseline::problem;
use super::document::Score;
use super::error::DiagnosisError;
use super::excitation::{Carried, carried};
use super::projector::Projector;
use super::split;
use super::start::ringing;
use super::weights::measure_noise;
use super::whitening::Whitening;
use quell_model::{Experiment, Model, Output, Term};
use quell_recording::Recording;
use serde::Serialize;
use std::num::NonZeroUsize;

/// How a recording is replayed, and to which samples its offsets, clocks and starts are fitted.
#[derive(Clone, Copy)]
enum Replay {
    /// Fitted to all samples; an axis that a force drives freely is replayed in windows, each with a start of
    /// its own.
    InWindows,
    /// Fitted to all samples, in one piece.
    InOnePiece,
    /// Fitted to the first samples only. It is in one piece, since a restart in the rest would use measured
    /// values.
    FromFirst(usize),
}

/// Prediction and recording of an output at its stamps.
pub struct Predicted {
    /// Role of the channel.
    pub name: &'static str,
    /// Unit.
    pub unit: String,
    /// Stamps, s.
    pub time: Vec<f64>,
    /// Recorded values.
    pub recorded: Vec<f64>,
    /// Values that the model predicts.
    pub predicted: Vec<f64>,
}

/// Predicts a recording; only clocks, offsets, frames and unknown starts are fitted.
///
/// The recording is consumed. The motion is simulated part by part: memory and time grow linearly with the
/// number of samples, at some hundred bytes each.
///
/// # Errors
/// [`DiagnosisError`] where the recording does not suit the model.
pub fn predict(
    model: &Model,
    recording: Recording,
) -> Result<(Vec<Predicted>, Score), DiagnosisError> {
    predicted(model, &[], (recording, 0), Replay::InWindows)
}

/// As [`predict`], but clocks, offsets, frames and unknown starts are fitted to the first `samples` of each
/// output only. The score is that of the rest, a prediction of data to which nothing was fitted.
///
/// # Errors
/// As [`predict`], and where an output has no more than `samples`.
pub fn forecast(
    model: &Model,
    recording: Recording,
    samples: NonZeroUsize,
) -> Result<(Vec<Predicted>, Score), DiagnosisError> {
    predicted(model, &[], (recording, 0), Replay::FromFirst(samples.get()))
}

/// The prediction with events of a set of recordings; `index` is that of this recording in the set.
fn predicted(
    model: &Model,
    happened: &[Term],
    (recording, index): (Recording, usize),
    replay: Replay,
) -> Result<(Vec<Predicted>, Score), DiagnosisError> {
    let name = recording.name.clone();
    let (mut experiments, first) = replayed(model, recording, replay)?;
    experiments[0].recording = index;
    let Left {
        residuals, noise, ..
    } = left(model, happened, &experiments, (first, false));
    let score = score_of(&experiments[0], &residuals[0], &noise, first);
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

/// The one experiment of a recording, and the number of samples to which it is fitted if not to all.
fn replayed(
    model: &Model,
    recording: Recording,
    replay: Replay,
) -> Result<(Vec<Experiment>, Option<usize>), DiagnosisError> {
    if let Carried::Nothing(words) = carried(model, std::slice::from_ref(&recording))? {
        let recording = recording.name;
        return Err(DiagnosisError::Still { recording, words });
    }
    let name = recording.name.clone();
    let mut experiments = vec![Experiment::of(model, recording)?];
    let first = match replay {
        Replay::FromFirst(first) => Some(first),
        Replay::InWindows | Replay::InOnePiece => None,
    };
    let lengths = experiments[0].outputs.iter().map(|o| o.values.len());
    let samples = lengths.min().unwrap_or(0);
    if let Some(first) = first.filter(|first| *first >= samples) {
        return Err(DiagnosisError::NothingFollows {
            recording: name,
            first,
            samples,
        });
    }
    if !matches!(replay, Replay::InWindows) {
        experiments[0].windows.clear();
    }
    Ok((experiments, first))
}

/// What a recording with a payload says of the link's inertia, beside a model that says nothing of its payload.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Carrying {
    /// The payload, as the recording names it.
    pub payload: String,
    /// Inertia of the link over the model's, by least squares.
    pub relative_inertia: f64,
    /// The score with that inertia.
    pub score: Score,
}

/// As [`predict`], or [`forecast`] with `first` samples, and with the link's inertia fitted; `None` where the recording
/// names no payload or says the inertia itself, and where the prediction runs away.
///
/// # Errors
/// As [`forecast`].
pub fn carrying(
    model: &Model,
    recording: &Recording,
    first: Option<NonZeroUsize>,
) -> Result<Option<Carrying>, DiagnosisError> {
    let Some(payload) = recording.payload.clone() else {
        return Ok(None);
    };
    let replay = first.map_or(Replay::InWindows, |first| Replay::FromFirst(first.get()));
    let (experiments, first) = replayed(model, recording.clone(), replay)?;
    if experiments[0].known.says_inertia() {
        return Ok(None);
    }
    let left = left(model, &[], &experiments, (first, true));
    let score = score_of(&experiments[0], &left.residuals[0], &left.noise, first);
    // Of a motion that runs away with every inertia nothing is told.
    let is_told = score.rms_over_noise.is_finite();
    Ok(is_told.then_some(Carrying {
        payload,
        relative_inertia: left.inertia,
        score,
    }))
}

/// What a model leaves of a recording.
struct Left {
    /// Residual of each output.
    residuals: Vec<Vec<f64>>,
    /// Noise of the first one.
    noise: Whitening,
    /// Inertia of the link over the model's.
    inertia: f64,
}

/// What a model leaves. The fit uses the first samples if `first` is given, else all. The inertia is the model's unless the
/// recording is `loaded`.
fn left(
    model: &Model,
    happened: &[Term],
    experiments: &[Experiment],
    (first, loaded): (Option<usize>, bool),
) -> Left {
    let rows = |experiment| match first {
        Some(first) => split::first(experiment, first),
        None => split::whole(experiment),
    };
    let rows = experiments.iter().map(rows).collect();
    let mut fit = problem(model, experiments, rows);
    fit.freeze();
    if loaded {
        // The model's own payload comes first, whatever it is.
        fit.payloads.insert(0, None);
        fit.free_payloads = 1..fit.payloads.len();
    }
    let mut start = fit.start(model);
    start.terms.extend_from_slice(happened);
    start.given_terms = start.terms.len();
    let mut projector = Projector::new(&fit);
    let still = fit.fit(&start, &projector, 15);
    let rough = ringing(&mut fit, still, &projector);
    if first.is_some() {
        // The noise is reported but does not affect the weights: it is also measured on the samples that
        // follow.
        let residuals = fit.explained(&rough.point, 0);
        measure_noise(&mut fit, &rough.point);
        return Left {
            residuals,
            noise: fit.noise[0][0].clone(),
            inertia: rough.point.inertias[usize::from(loaded)],
        };
    }
    measure_noise(&mut fit, &rough.point);
    projector = Projector::new(&fit);
    let fitted = fit.fit(&rough.point, &projector, 15);
    drop(projector);
    Left {
        residuals: fit.explained(&fitted.point, 0),
        noise: fit.noise[0][0].clone(),
        inertia: fitted.point.inertias[usize::from(loaded)],
    }
}

impl Predicted {
    /// Prediction of an output from its residual.
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

/// The score of [`predict`].
///
/// # Errors
/// As [`predict`].
pub fn score(model: &Model, recording: &Recording) -> Result<Score, DiagnosisError> {
    Ok(predict(model, recording.clone())?.1)
}

/// As [`score`], but in one piece even if a force drives the model freely, and with events of a set of
/// recordings; `index` is that of this recording in the set.
///
/// # Errors
/// As [`predict`].
pub(super) fn score_in_one_piece(
    model: &Model,
    happened: &[Term],
    recording: &Recording,
    index: usize,
) -> Result<Score, DiagnosisError> {
    let recording = (recording.clone(), index);
    Ok(predicted(model, happened, recording, Replay::InOnePiece)?.1)
}

/// Score of the first output's residual; rows that were fitted are left out if only the first were.
fn score_of(
    experiment: &Experiment,
    residual: &[f64],
    noise: &Whitening,
    first: Option<usize>,
) -> Score {
    let (output, from) = (&experiment.outputs[0], first.unwrap_or(0));
    let residual = &residual[from..];
    let n = residual.len() as f64;
    let square: f64 = residual.iter().map(|r| r * r).sum();
    let shown = super::draw::shown(experiment, output);
    let shown = &shown[from..];
    let mean = shown.iter().sum::<f64>() / n;
    let spread: f64 = shown.iter().map(|y| (y - mean).powi(2)).sum();
    Score {
        rms: (square / n).sqrt() * output.scale,
        unit: output.unit.clone(),
        noise_std: noise.deviation * output.scale,
        rms_over_noise: noise.power(residual).sqrt(),
        fit_percent: 100.0 * (1.0 - (square / spread).sqrt()),
        samples: residual.len(),
        motion: shown.iter().fold(0.0, |most: f64, y| most.max(y.abs())) * output.scale,
        windows: 1 + experiment.windows.len(),
        first,
    }
}

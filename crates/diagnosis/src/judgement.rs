//! A score, and that with the payload of the recording.

use super::document::Score;
use super::error::DiagnosisError;
use super::score::{Carrying, carrying, forecast, predict};
use quell_model::Model;
use quell_recording::Recording;
use serde::Serialize;
use std::num::NonZeroUsize;

/// How well a model predicts a recording, as it stands and with the inertia of the recording's payload.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// The score of the model as it stands.
    #[serde(flatten)]
    pub score: Score,
    /// That with the link's inertia fitted, where the recording names a payload.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_payload: Option<Carrying>,
}

/// Judges a model by a recording; offsets, clocks and start are fitted to all samples, or to the `first` alone.
///
/// # Errors
/// As [`predict`] and [`forecast`].
pub fn judge(
    model: &Model,
    recording: Recording,
    first: Option<NonZeroUsize>,
) -> Result<Judgement, DiagnosisError> {
    let named = recording.payload.is_some().then(|| recording.clone());
    let (_, score) = match first {
        Some(samples) => forecast(model, recording, samples)?,
        None => predict(model, recording)?,
    };
    let with_payload = match named {
        Some(recording) => carrying(model, &recording, first)?,
        None => None,
    };
    Ok(Judgement {
        score,
        with_payload,
    })
}

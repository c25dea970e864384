//! The diagnosis of recordings in which nothing varies.

use super::words::nothing_moved;
use crate::document::{Diagnosis, Fit, Location, Quality, Verdict};
use crate::error::DiagnosisError;
use crate::outcome::Outcome;
use crate::remarks::recorded;
use crate::traces::Traces;
use quell_model::Model;
use quell_recording::Recording;
use std::collections::BTreeMap;

/// The diagnosis without a fit: the model is returned as given, and misfit and noise are 0.
///
/// # Errors
/// [`DiagnosisError::NoRecording`] where there is none.
pub fn silent(
    model: &Model,
    recordings: &[Recording],
    still: &str,
) -> Result<Outcome, DiagnosisError> {
    let channels = recordings.iter().flat_map(|recording| &recording.channels);
    let mut outputs = channels.filter(|channel| model.kind.outputs.contains(&channel.role));
    let output = outputs.next().ok_or(DiagnosisError::NoRecording)?;
    let nothing = Quality {
        train_rms: 0.0,
        held_out_rms: 0.0,
        held_out_over_noise: 0.0,
    };
    Ok(Outcome {
        diagnosis: Diagnosis {
            verdict: Verdict::NotExcited,
            summary: nothing_moved(still, model),
            findings: Vec::new(),
            location: Location::default(),
            fit: Fit {
                noise_std: 0.0,
                unit: output.unit.clone(),
                before: nothing,
                after: nothing,
                model_alone: None,
                scores: Vec::new(),
            },
            nuisances: BTreeMap::new(),
            nuisances_ci95: BTreeMap::new(),
            next_move: None,
            candidates: Vec::new(),
            ended_early: false,
            remarks: recorded(recordings),
        },
        model: model.clone(),
        happened: Vec::new(),
        traces: Traces::default(),
        units: None,
    })
}

//! Whether a recording was sampled often enough to show the model's mode.

use crate::error::DiagnosisError;
use quell_model::{Experiment, Hold, Model};
use quell_recording::Recording;
use std::f64::consts::TAU;

/// Refuses a recording if its input, or all of its outputs, have two samples or less in a period of the model's
/// mode.
///
/// Slower samples show the mode at another frequency, `|f - k f_s|`, which a fit would then find. An input that
/// is held between its samples is known at all times, so that its rate does not matter.
///
/// Source: Nyquist, Shannon, Communication in the presence of noise, Proc. IRE 37 (1949).
///
/// # Errors
/// [`DiagnosisError::TooSlow`] with the rate of the recording.
pub fn sampled(
    model: &Model,
    experiments: &[Experiment],
    recordings: &[Recording],
) -> Result<(), DiagnosisError> {
    let hertz = model.mode().map_or(model.fastest() / TAU, |mode| mode.0);
    for experiment in experiments {
        let outputs = experiment
            .outputs
            .iter()
            .map(|own| (own.channel, rate(&own.time)));
        let Some(fastest) = outputs.max_by(|a, b| a.1.total_cmp(&b.1)) else {
            continue;
        };
        let input = (experiment.input, rate(&experiment.input_time));
        let open = experiment.hold != Hold::ZeroOrder;
        let slowest = [Some(fastest), open.then_some(input)];
        let slow = slowest
            .into_iter()
            .flatten()
            .find(|own| own.1 <= 2.0 * hertz);
        if let Some((channel, rate_hz)) = slow {
            let recording = recordings.get(experiment.recording);
            return Err(DiagnosisError::TooSlow {
                recording: recording.map_or_else(String::new, |own| own.name.clone()),
                channel,
                rate_hz,
                mode_hz: hertz,
            });
        }
    }
    Ok(())
}

/// Samples per second, Hz; infinite for fewer than two.
fn rate(time: &[f64]) -> f64 {
    match time {
        [first, .., last] if last > first => (time.len() - 1) as f64 / (last - first),
        _ => f64::INFINITY,
    }
}

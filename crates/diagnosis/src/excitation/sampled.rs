//! Whether a recording was sampled often enough to show the model's mode.

use crate::error::DiagnosisError;
use quell_model::{Experiment, Hold, Model};
use quell_recording::{Channel, Recording};
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

/// The same for the outputs before anything is simulated, by their median rate: what is much too slow, as stamps in the
/// wrong unit are, would take some 10^12 steps of the integration.
///
/// # Errors
/// As [`sampled`].
pub fn dense(
    model: &Model,
    recording: &Recording,
    outputs: &[&Channel],
) -> Result<(), DiagnosisError> {
    let mode_hz = model.mode().map_or(model.fastest() / TAU, |mode| mode.0);
    let rates = outputs.iter().map(|own| (own.role, median_rate(&own.time)));
    match rates.max_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((channel, rate_hz)) if rate_hz <= 2.0 * mode_hz => Err(DiagnosisError::TooSlow {
            recording: recording.name.clone(),
            channel,
            rate_hz,
            mode_hz,
        }),
        _ => Ok(()),
    }
}

/// One over the median time between two samples, Hz; infinite for fewer than two samples.
fn median_rate(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    match steps.is_empty() {
        true => f64::INFINITY,
        false => 1.0 / *steps.select_nth_unstable_by(middle, f64::total_cmp).1,
    }
}

/// Samples per second, Hz; infinite for fewer than two.
pub(super) fn rate(time: &[f64]) -> f64 {
    match time {
        [first, .., last] if last > first => (time.len() - 1) as f64 / (last - first),
        _ => f64::INFINITY,
    }
}

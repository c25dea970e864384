//! Sensors that show only noise while the machine moves.

use crate::error::DiagnosisError;
use crate::figure::figure;
use crate::spread::spread;
use crate::units::of_values;
use quell_model::{Departure, Experiment, Model, predict_windows};
use quell_recording::Recording;
use quell_signal::noise_floor;

/// Ratio of prediction to recording that proves a dead sensor: a model with a smaller error may still be one of
/// this machine.
const MUTE: f64 = 5.0;
/// Five standard deviations of the ratio of two variance estimates from `N` samples, times `sqrt N`: that of
/// the samples has `sqrt 2`, that from the median of third differences about 3.4.
const SPREAD: f64 = 19.0;

/// Refuses recordings with such a sensor. The model is used as given, from rest.
///
/// # Errors
/// [`DiagnosisError::Mute`].
pub fn mute(
    model: &Model,
    recordings: &[Recording],
    experiments: &[Experiment],
) -> Result<(), DiagnosisError> {
    for (recording, experiment) in recordings.iter().zip(experiments) {
        // Each window has a start of its own from its sensors; a dead sensor gives none.
        if !experiment.windows.is_empty() {
            continue;
        }
        let clocks: Vec<f64> = experiment.outputs.iter().map(|o| o.clock_offset).collect();
        let (keys, terms) = (model.keys(), model.terms());
        let start = &[Departure::default()];
        let shown = predict_windows(model.kind, &keys, &terms, experiment, start, &clocks);
        for (output, shown) in experiment.outputs.iter().zip(shown) {
            // Only the mean is taken out: the frame's columns are made of the tracker's angle and would explain
            // a short arc.
            let [recorded, predicted] = [&output.values, &shown.values].map(|v| spread(v));
            let noise = noise_floor(&output.values).standard_deviation;
            let noisy = recorded > 0.0 && is_noise(recorded.powi(2), noise, shown.values.len());
            if noisy && predicted > MUTE * recorded {
                let unit = of_values(experiment, output);
                return Err(DiagnosisError::Mute {
                    recording: recording.name.clone(),
                    channel: output.channel,
                    noise: figure(noise, &unit),
                    moving: experiment.input,
                    by: figure(predicted, &unit),
                });
            }
        }
    }
    Ok(())
}

/// Whether a variance of so many samples is that of noise of this level, within chance.
pub fn is_noise(variance: f64, noise: f64, samples: usize) -> bool {
    variance <= noise.powi(2) * (1.0 + SPREAD / (samples as f64).sqrt())
}

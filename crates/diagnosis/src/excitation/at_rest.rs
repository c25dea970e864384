//! Encoders at rest, whose readings are noise without motion.

use super::mute::is_noise;
use quell_model::Experiment;
use quell_recording::Role;
use quell_signal::noise_floor;

/// The experiment with a constant input if the encoder that drives it shows only noise: the noise would pass
/// for a motion that the link does not follow.
pub fn at_rest(experiment: Experiment) -> Experiment {
    let values = &experiment.input_values;
    let kinematic = matches!(
        experiment.input,
        Role::MotorPosition | Role::CommandPosition
    );
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / count;
    let noise = noise_floor(values).standard_deviation;
    match kinematic && is_noise(variance, noise, values.len()) {
        true => experiment.with_input(vec![mean; values.len()]),
        false => experiment,
    }
}

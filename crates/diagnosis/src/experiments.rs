//! The experiments that recordings are, and what couples them to what was measured.

use super::error::DiagnosisError;
use super::excitation::at_rest;
use super::stretches::Stretches;
use quell_model::chain::MotorSide;
use quell_model::{Experiment, Model};
use quell_recording::Role;
use quell_signal::noise_floor;

/// Share of the driving force that an error of it has, which a coupled motor side must show: a tenth of what a law of
/// the catalogue typically takes.
const SEEN: f64 = 0.01;

/// One for each recording, or stretch of one.
pub fn experiments(
    model: &Model,
    stretches: &Stretches,
) -> Result<Vec<Experiment>, DiagnosisError> {
    let mut all = Vec::new();
    for (part, &recording) in stretches.recordings.iter().zip(&stretches.of) {
        let mut experiment = at_rest(Experiment::new(model, part)?);
        experiment.recording = recording;
        all.push(experiment);
    }
    Ok(all)
}

/// The same, each motor side coupled to its measured motion as strongly as its samples allow.
pub fn coupled(all: &[Experiment]) -> Vec<Experiment> {
    all.iter().map(|own| own.coupled(strongest(own))).collect()
}

/// Whether an error of the force shows where the motor side is coupled to its measured motion: with a rate `w` a force
/// that is wrong by `dF` moves a mass `m` by `dF / (m w^2)`, which has to be above the noise of the encoder.
pub fn sees_forces(model: &Model, own: &Experiment) -> bool {
    let mut outputs = own.outputs.iter();
    let Some(encoder) = outputs.find(|output| output.role == Role::MotorPosition) else {
        return false;
    };
    let linear = (model.kind.linear)(&model.keys(), own.input);
    let MotorSide::Free { inertia, .. } = linear.motor else {
        return false;
    };
    let squares: f64 = own.input_values.iter().map(|force| force * force).sum();
    let force = linear.motor_gain * (squares / own.input_values.len() as f64).sqrt();
    let noise = noise_floor(&encoder.values).standard_deviation;
    inertia * strongest(own).powi(2) * noise < SEEN * force.abs()
}

/// Rate of a coupling that remembers four samples, rad/s: what a sampled force is wrong by within a sample stays small.
fn strongest(experiment: &Experiment) -> f64 {
    let (from, until) = experiment.span();
    let samples = experiment.input_time.len() as f64 - 1.0;
    0.25 * samples / (until - from)
}

//! Experiments from recordings, and their coupling to the measured motion.

use super::error::DiagnosisError;
use super::excitation::at_rest;
use super::spread::spread;
use super::stretches::Stretches;
use quell_model::chain::MotorSide;
use quell_model::{Experiment, Model};
use quell_recording::Role;
use quell_signal::noise_floor;
use std::f64::consts::PI;

/// Least error of the driving force that a coupled motor side must show, as a share of the force: a tenth of
/// the typical size of a law of the catalogue.
const SEEN: f64 = 0.01;
/// `w t` after which an error has fallen to a twentieth: `(1 + w t) exp(-w t)`.
const FORGOTTEN: f64 = 4.74;

/// One experiment for each recording, or stretch of one.
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

/// The experiments with each motor side coupled to its measured motion; `None` if one of them would not show an
/// error of the force.
pub fn coupled(model: &Model, all: &[Experiment]) -> Option<Vec<Experiment>> {
    let one = |own: &Experiment| Some(own.coupled(rate(model, own)?));
    all.iter().map(one).collect()
}

/// Rate of the coupling, rad/s: the strongest one that still shows an error of the force. `None` if the
/// response has not decayed before the motion turns. With a rate `w` a force error `dF` moves a mass `m` by `dF
/// / (m w^2)`, which must be above the encoder's noise. The motion turns after half a period of a vibration of
/// the same acceleration and position.
fn rate(model: &Model, own: &Experiment) -> Option<f64> {
    let mut outputs = own.outputs.iter();
    let encoder = outputs.find(|output| output.role == Role::MotorPosition)?;
    let linear = (model.kind.linear)(&model.keys(), own.input);
    let MotorSide::Free { inertia, .. } = linear.motor else {
        return None;
    };
    let acceleration = (linear.motor_gain * spread(&own.input_values) / inertia).abs();
    let noise = noise_floor(&encoder.values).standard_deviation;
    let rate = strongest(own).min((SEEN * acceleration / noise).sqrt());
    let turns = PI / (acceleration / spread(&encoder.values)).sqrt();
    (rate * turns > FORGOTTEN).then_some(rate)
}

/// Rate of a coupling with a memory of four samples, rad/s: the error of a sampled force between its samples
/// stays small.
fn strongest(experiment: &Experiment) -> f64 {
    let (from, until) = experiment.span();
    let samples = experiment.input_time.len() as f64 - 1.0;
    0.25 * samples / (until - from)
}

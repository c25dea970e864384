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
/// `w t` after which the error of a start has fallen to a twentieth, as at the end of a window: `(1 + w t) exp(-w t)`.
const FORGOTTEN: f64 = 4.74;

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

/// The same, each motor side coupled to its measured motion; none where one of them is not seen so.
pub fn coupled(model: &Model, all: &[Experiment]) -> Option<Vec<Experiment>> {
    let one = |own: &Experiment| Some(own.coupled(rate(model, own)?));
    all.iter().map(one).collect()
}

/// Rate of the coupling, rad/s: the strongest that still shows an error of the force, if it forgets within a window, which
/// an axis that is not coupled is looked at in. With a rate `w` a force that is wrong by `dF` moves a mass `m` by
/// `dF / (m w^2)`, which has to be above the noise of the encoder.
fn rate(model: &Model, own: &Experiment) -> Option<f64> {
    let mut outputs = own.outputs.iter();
    let encoder = outputs.find(|output| output.role == Role::MotorPosition)?;
    let linear = (model.kind.linear)(&model.keys(), own.input);
    let MotorSide::Free { inertia, .. } = linear.motor else {
        return None;
    };
    let squares: f64 = own.input_values.iter().map(|force| force * force).sum();
    let force = linear.motor_gain * (squares / own.input_values.len() as f64).sqrt();
    let noise = noise_floor(&encoder.values).standard_deviation;
    let seen = (SEEN * force.abs() / (inertia * noise)).sqrt();
    let rate = strongest(own).min(seen);
    let (from, until) = own.span();
    let window = (until - from) / (own.windows.len() + 1) as f64;
    (rate * window > FORGOTTEN).then_some(rate)
}

/// Rate of a coupling that remembers four samples, rad/s: what a sampled force is wrong by within a sample stays small.
fn strongest(experiment: &Experiment) -> f64 {
    let (from, until) = experiment.span();
    let samples = experiment.input_time.len() as f64 - 1.0;
    0.25 * samples / (until - from)
}

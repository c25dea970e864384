//! Information in the channels of a recording, before any model is fitted.

use super::sampled::dense;
use super::words::still;
use crate::error::DiagnosisError;
use crate::figure::figure;
use quell_model::Model;
use quell_recording::{Channel, Recording, Role};
use quell_signal::{Contradiction, Hang, Hangs};

/// Fewest samples for an estimate of the noise: five third differences, whose median is taken.
const NOISE: usize = 8;
/// Unknowns that each recording adds: offset and clock of the sensor, two of the start.
const OWN: usize = 4;

/// Content of the recordings.
#[derive(Clone, Debug, PartialEq)]
pub enum Carried {
    /// Something varies in each recording.
    Motion,
    /// Nothing varies in any recording; the sentence says so.
    Nothing(String),
}

/// Checks the channels of recordings that a model uses as input or predicts.
///
/// [`DiagnosisError`] if a channel has too few samples or an impossible value, if a sensor is constant while
/// the machine moves, if the link at rest is not where the motor side took it, or if nothing varies in one recording of
/// several.
pub fn carried(model: &Model, recordings: &[Recording]) -> Result<Carried, DiagnosisError> {
    let mut silent = Vec::new();
    for recording in recordings {
        let Some(input) = input(model, recording) else {
            continue;
        };
        let is_output = |channel: &&Channel| {
            channel.role != input.role && model.kind.outputs.contains(&channel.role)
        };
        let outputs: Vec<&Channel> = recording.channels.iter().filter(is_output).collect();
        sound(model, recording, input, &outputs)?;
        dense(model, recording, &outputs)?;
        follows(recording, input, &outputs)?;
        if nothing_varies(recording, input, &outputs)? {
            let all = std::iter::once(input).chain(outputs);
            silent.push((recording, still(all)));
        }
    }
    match silent.first() {
        None => Ok(Carried::Motion),
        Some((_, words)) if silent.len() == recordings.len() => Ok(Carried::Nothing(words.clone())),
        Some((recording, words)) => Err(DiagnosisError::Still {
            recording: recording.name.clone(),
            words: words.clone(),
        }),
    }
}

/// The channel that drives the model.
fn input<'a>(model: &Model, recording: &'a Recording) -> Option<&'a Channel> {
    let mut roles = model.kind.inputs.iter();
    roles.find_map(|role| recording.channel(*role).filter(|_| model.takes(*role)))
}

/// Checks that there are enough samples, each of a possible value.
fn sound(
    model: &Model,
    recording: &Recording,
    input: &Channel,
    outputs: &[&Channel],
) -> Result<(), DiagnosisError> {
    let believed = |index: &usize| model.kind.keys[*index].belief > 0.0;
    let keys = (0..model.values.len()).filter(believed).count();
    // A third is held out; the fitted part must be enough to estimate the noise.
    let needed = 3 * (keys + OWN + NOISE) / 2;
    for channel in outputs {
        if channel.time.len() < needed {
            return Err(DiagnosisError::TooFew {
                recording: recording.name.clone(),
                channel: channel.role,
                found: channel.time.len(),
                needed,
            });
        }
    }
    for channel in std::iter::once(&input).chain(outputs) {
        if let Some(value) = channel.impossible() {
            return Err(DiagnosisError::NoMeasurement {
                recording: recording.name.clone(),
                channel: channel.role,
                value,
                unit: channel.unit.clone(),
            });
        }
    }
    Ok(())
}

/// Checks that no sensor hangs, and that the link goes as far as the motor side that drives it, and follows it, where both are
/// measured.
///
/// Where friction holds the link, its deformation stays at one value, too: only a run without the sensor's noise is a fault
/// there.
fn follows(
    recording: &Recording,
    input: &Channel,
    outputs: &[&Channel],
) -> Result<(), DiagnosisError> {
    let has_link = outputs.iter().any(|own| own.role == Role::LinkPosition);
    let are_two = has_link && input.role == Role::MotorPosition;
    let hangs = || {
        let hangs = Hangs::of(recording)?;
        let is_fault = |run: &Hang| {
            let is_used = std::iter::once(&input)
                .chain(outputs)
                .any(|own| own.role == run.role);
            is_used && (run.lacks_noise || are_two && run.role != Role::Deformation)
        };
        let all: Vec<Hang> = hangs.runs.into_iter().filter(is_fault).collect();
        (!all.is_empty()).then(|| Hangs { runs: all }.contradiction())
    };
    let mistake = || {
        let own = Contradiction::of(recording).filter(|_| has_link)?;
        (own.motor_side == input.role).then_some(own.words)
    };
    hangs().or_else(mistake).map_or(Ok(()), |words| {
        Err(DiagnosisError::Contradiction {
            recording: recording.name.clone(),
            words,
        })
    })
}

/// Whether neither the input nor any output varies.
fn nothing_varies(
    recording: &Recording,
    input: &Channel,
    outputs: &[&Channel],
) -> Result<bool, DiagnosisError> {
    let dead = |channel: &Channel, moving: &Channel| DiagnosisError::Dead {
        recording: recording.name.clone(),
        channel: channel.role,
        value: figure(channel.columns[0][0], &channel.unit),
        moving: moving.role,
        by: figure(moving.travel(), &moving.unit),
    };
    if input.varies() {
        return match outputs.iter().find(|output| !output.varies()) {
            Some(output) => Err(dead(output, input)),
            None => Ok(false),
        };
    }
    // Channels that show motion although the input is constant.
    let commanded = |channel: &&Channel| {
        let also = matches!(channel.role, Role::CommandPosition | Role::MotorPosition);
        also && input.role.is_position() && channel.role != input.role && channel.varies()
    };
    let moving = recording.channels.iter().find(commanded);
    match moving.filter(|moving| !outputs.iter().any(|output| output.role == moving.role)) {
        Some(moving) => Err(dead(input, moving)),
        None => Ok(outputs.iter().all(|output| !output.varies())),
    }
}

//! A diagnosis from a model and recordings, with the course of the input between its samples that these show.

use super::candidate::Known;
use super::error::DiagnosisError;
use super::excitation::{Carried, carried, sampled, silent};
use super::experiments::experiments;
use super::input_hold::{Held, held_beside, held_input};
use super::looks::{explains, explains_by_findings, look};
use super::outcome::{Options, Outcome, Progress};
use super::run::Looked;
use super::stretches::{Stretches, is_whole, stretches};
use quell_model::{Experiment, Model};
use quell_recording::Recording;

/// Says what physics a model lacks, from recordings of the machine.
///
/// `held_out` recordings judge the fit to `train`. Without them every third stretch of three periods is kept
/// apart. The same input and seed give the same answer.
///
/// # Errors
/// [`DiagnosisError`] where a recording does not suit the model, or it is stopped.
pub fn diagnose(
    model: &Model,
    train: &[Recording],
    held_out: &[Recording],
    options: &Options,
    progress: Progress,
) -> Result<Outcome, DiagnosisError> {
    progress(0.0, "reading the recordings");
    if train.is_empty() {
        return Err(DiagnosisError::NoRecording);
    }
    carried(model, held_out)?;
    if let Carried::Nothing(words) = carried(model, train)? {
        return silent(model, train, &words);
    }
    let (known, apart) = (stretches(train), stretches(held_out));
    let usual = experiments(model, &known)?;
    sampled(model, &usual, train)?;
    let mut outcome = look_as_held(model, usual, (&known, &apart), options, progress)?;
    if options.stop.was_asked() {
        return Err(DiagnosisError::Stopped);
    }
    // A recording that was used in parts has no score of its own.
    let all = || train.iter().chain(held_out);
    let is_one = |name: &str| all().any(|own| is_whole(own) && own.name == name);
    let scores = &mut outcome.diagnosis.fit.scores;
    scores.retain(|own| is_one(&own.recording));
    let left_out = known.remarks.into_iter().chain(apart.remarks);
    outcome.diagnosis.remarks.splice(0..0, left_out);
    outcome.diagnosis.check()?;
    where_it_happened(&mut outcome, train);
    Ok(outcome)
}

/// Lists for each finding the recordings in which it happened.
fn where_it_happened(outcome: &mut Outcome, recordings: &[Recording]) {
    for finding in &mut outcome.diagnosis.findings {
        let own = outcome.happened.iter().filter(|term| {
            term.effect.name == finding.effect && term.place.name() == finding.place
        });
        let indices = own.filter_map(|term| term.recording);
        let names = indices.map(|index| recordings[index].name.clone());
        finding.happened_in = names.collect();
    }
}

/// A look with the course of the input between its samples that the recordings show, where the model does not say it. What
/// is found may show another one than the model did before: then it is looked again.
fn look_as_held(
    model: &Model,
    usual: Vec<Experiment>,
    recordings: (&Stretches, &Stretches),
    options: &Options,
    progress: Progress,
) -> Result<Outcome, DiagnosisError> {
    let unknown = Known::default();
    if model.hold.is_some() {
        return Ok(look(model, usual, recordings, &unknown, options, progress)?.outcome);
    }
    let held = held_input(model, recordings.0, &usual)?;
    let look_at = |held: &Held, seen| look_held(held, recordings, seen, options, progress);
    let (first, used) = match held {
        None => {
            let fitted = usual.clone();
            let first = look(model, fitted, recordings, &unknown, options, progress)?;
            (first, usual)
        }
        Some(held) => (look_at(&held, &unknown)?, held.experiments),
    };
    if first.outcome.diagnosis.findings.is_empty() || options.enough.now() {
        return Ok(first.outcome);
    }
    let Some(mut held) = held_beside(&first.outcome.model, recordings.0, &used)? else {
        return Ok(first.outcome);
    };
    held.model = Model {
        hold: held.model.hold,
        ..model.clone()
    };
    let seen = Known {
        points: first.points,
        alone: true,
    };
    let mut again = look_at(&held, &seen)?.outcome;
    if !explains_by_findings(&again) && left(&again) >= left(&first.outcome) {
        again = look_at(&held, &unknown)?.outcome;
    }
    let may_stay = explains(&first.outcome) || options.enough.now();
    Ok(match may_stay && !explains(&again) {
        true => first.outcome,
        false => again,
    })
}

/// Sum of squares of what a better model leaves of each recording.
fn left(own: &Outcome) -> f64 {
    let scores = own.diagnosis.fit.scores.iter();
    scores.map(|own| own.after.rms.powi(2)).sum()
}

/// A look with a model that says how its input runs between the samples.
fn look_held(
    held: &Held,
    recordings: (&Stretches, &Stretches),
    seen: &Known,
    options: &Options,
    progress: Progress,
) -> Result<Looked, DiagnosisError> {
    let fitted = held.experiments.clone();
    let mut looked = look(&held.model, fitted, recordings, seen, options, progress)?;
    looked.outcome.diagnosis.remarks.push(format!(
        "The input was taken as {}, which explains the recordings better. The model that is written says so \
         (`input_hold`).",
        held.words
    ));
    Ok(looked)
}

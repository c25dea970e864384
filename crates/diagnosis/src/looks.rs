//! Looks at recordings. If a force drives the motor side freely, there are up to three: coupled to its measured motion, in
//! windows that each have a start of their own, and in one piece.

use super::candidate::Known;
use super::document::{Scored, Verdict};
use super::error::DiagnosisError;
use super::excitation::mute;
use super::experiments::{coupled, experiments};
use super::outcome::{Options, Outcome, Progress};
use super::run::{Looked, attempt};
use super::score::score_in_one_piece;
use super::stretches::Stretches;
use super::thresholds::LOST;
use quell_model::chain::MotorSide;
use quell_model::{Experiment, Model};
use quell_recording::Recording;

/// Remark on a diagnosis that was made coupled.
const COUPLED: &str = "Errors of a force that drives an axis freely add up without bound. So the motor side was simulated \
    coupled to its measured motion, by a spring and a damper. Its residual is that of this simulation.";

/// Remark on a diagnosis that was made in windows.
const WINDOWED: &str = "Errors of a force that drives an axis freely add up without bound. So the motion was simulated in \
    windows, each with a start of its own.";

/// A look at recordings of limited length; `fitted` holds the experiments of those that are fitted, `seen` the
/// explanations of another look.
pub(super) fn look(
    model: &Model,
    fitted: Vec<Experiment>,
    (known, held_out): (&Stretches, &Stretches),
    seen: &Known,
    options: &Options,
    progress: Progress,
) -> Result<Looked, DiagnosisError> {
    let train = &known.recordings[..];
    let mut apart = experiments(model, held_out)?;
    for experiment in &mut apart {
        experiment.recording += train.len();
    }
    mute(model, train, &fitted)?;
    mute(model, &held_out.recordings, &apart)?;
    let once = |pieces, known: &Known| {
        attempt(
            model,
            (train, &held_out.recordings),
            pieces,
            known,
            options,
            progress,
        )
    };
    // A motor side whose motion was recorded does not drift: its windows begin after gaps.
    let drifts = (model.kind.linear)(&model.keys(), fitted[0].input).motor != MotorSide::Prescribed;
    if fitted[0].windows.is_empty() || !drifts {
        return once((fitted, apart), seen);
    }
    // Coupled to the measured motion, an error of the force shows where and when it acts, and a fit has few
    // minima. But an effect that lasts longer than the coupling's memory, such as a sensor lag, is hidden, and
    // keys of the model absorb it. Then they leave their believed range, or the uncoupled motion fits hardly
    // better.
    let mut in_noise = None;
    let in_windows = || match apart.is_empty() {
        // Each window has a start of its own, so rows of it cannot be held out. Whole windows are held out
        // instead.
        true => in_two(model, train, &fitted),
        false => Ok((fitted.clone(), apart.clone())),
    };
    if let Some((fitted, apart)) = coupled(model, &fitted).zip(coupled(model, &apart)) {
        let when_coupled = |known: &Known| -> Result<Looked, DiagnosisError> {
            let mut looked = once((fitted.clone(), apart.clone()), known)?;
            looked.outcome.diagnosis.remarks.push(COUPLED.into());
            Ok(looked)
        };
        let mut looked = when_coupled(seen)?;
        if options.enough.now() {
            return Ok(ended_early(looked));
        }
        if looked.believable && halves(&looked.outcome) {
            // The coupling takes the motion back within its memory, and with it most of what a slow error does. If
            // the same findings explain the windows, too, these determine the parameters far better.
            let found = Known {
                points: looked.points.clone(),
                alone: true,
            };
            let longer = windowed(once(in_windows()?, &found)?);
            return Ok(match explains_by_findings(&longer.outcome) {
                true => longer,
                false if options.enough.now() => ended_early(looked),
                false => looked,
            });
        }
        // The findings do not improve the uncoupled motion: is the coupled motion noise without them, too?
        if explains_by_findings(&looked.outcome) {
            let nothing = Known {
                alone: true,
                ..Known::default()
            };
            looked = when_coupled(&nothing)?;
        }
        if options.enough.now() {
            return Ok(ended_early(looked));
        }
        let is_noise = looked.outcome.diagnosis.verdict == Verdict::NoMismatch;
        in_noise = is_noise.then_some(looked);
    }
    let whole = (in_one(&fitted), in_one(&apart));
    // In one piece a small error of a force moves the end of the motion far, and a fit ends in the nearest of
    // many minima. In windows there are few minima, so their findings give the starts for the fit in one piece.
    // But small effects show in one piece only.
    let in_windows = windowed(once(in_windows()?, seen)?);
    // If the model explains the coupled motion down to the noise, it lacks at most slower physics, which
    // windows show.
    if let Some(looked) = in_noise {
        return Ok(match halves(&in_windows.outcome) {
            true => in_windows,
            false if options.enough.now() => ended_early(looked),
            false => looked,
        });
    }
    if options.enough.now() {
        return Ok(ended_early(in_windows));
    }
    let alone = explains_by_findings(&in_windows.outcome);
    let found = Known {
        points: in_windows.points.clone(),
        alone,
    };
    let in_one = once(whole, &found)?;
    if explains(&in_one.outcome) {
        return Ok(in_one);
    }
    // Findings that reduce a mismatch to the noise in windows are right, even if small errors add up in one
    // piece.
    let left = |own: &Looked| own.outcome.diagnosis.fit.after.held_out_rms;
    let is_right = alone && left(&in_windows) < left(&in_one);
    let is_better = is_right || is_better(&in_windows.outcome, &in_one.outcome, known);
    Ok(match is_better {
        true if options.enough.now() => ended_early(in_windows),
        true => in_windows,
        false => in_one,
    })
}

/// A look, if there was no time for another one.
fn ended_early(mut looked: Looked) -> Looked {
    looked.outcome.diagnosis.end_early();
    looked
}

/// A look in windows, which says so.
fn windowed(mut looked: Looked) -> Looked {
    looked.outcome.diagnosis.remarks.push(WINDOWED.into());
    looked
}

/// Whether `one` is better than `other`, where both leave more than noise: the simpler one is better, unless it
/// predicts the recordings far worse in one piece.
fn is_better(one: &Outcome, other: &Outcome, train: &Stretches) -> bool {
    let [own, theirs] = [one, other].map(|own| misses(own, train));
    let count = |own: &Outcome| own.diagnosis.findings.len();
    match count(one) == count(other) {
        true => own < theirs,
        false if count(one) < count(other) => own < LOST * theirs,
        false => LOST * own < theirs,
    }
}

/// Whether the findings at least halve the error of each recording's uncoupled motion.
fn halves(outcome: &Outcome) -> bool {
    let halves = |own: &Scored| LOST * own.after.rms.powi(2) < own.before.rms.powi(2);
    outcome.diagnosis.fit.scores.iter().all(halves)
}

/// Whether a diagnosis leaves only noise.
pub(super) fn explains(outcome: &Outcome) -> bool {
    use Verdict::{Ambiguous, Named, NoMismatch, NotExcited};
    let verdict = outcome.diagnosis.verdict;
    matches!(verdict, NoMismatch | Named | Ambiguous | NotExcited)
}

/// Whether a diagnosis leaves only noise by what it found.
pub(super) fn explains_by_findings(outcome: &Outcome) -> bool {
    explains(outcome) && !outcome.diagnosis.findings.is_empty()
}

/// Mean square error, in units of the noise, of a model and the events found, in one piece, summed over recordings.
fn misses(own: &Outcome, train: &Stretches) -> f64 {
    let square = |(part, &recording): (&Recording, &usize)| {
        let score = score_in_one_piece(&own.model, &own.happened, part, recording);
        score.map_or(f64::INFINITY, |score| score.rms_over_noise.powi(2))
    };
    let parts = train.recordings.iter().zip(&train.of);
    parts.map(square).sum()
}

/// The same experiments in one piece, without restarts.
fn in_one(experiments: &[Experiment]) -> Vec<Experiment> {
    let mut whole = experiments.to_vec();
    whole.iter_mut().for_each(|e| e.windows.clear());
    whole
}

/// The first two thirds of the windows of each recording, and the last third.
fn in_two(
    model: &Model,
    recordings: &[Recording],
    whole: &[Experiment],
) -> Result<(Vec<Experiment>, Vec<Experiment>), DiagnosisError> {
    let (mut fitted, mut apart) = (Vec::new(), Vec::new());
    for (recording, experiment) in recordings.iter().zip(whole) {
        let count = experiment.windows.len();
        let Some(cut) = experiment.windows.get(2 * count / 3) else {
            fitted.push(experiment.clone());
            continue;
        };
        let (before, after) = recording.at(cut.time);
        for (part, parts) in [(before, &mut fitted), (after, &mut apart)] {
            parts.push(Experiment {
                recording: experiment.recording,
                ..Experiment::new(model, &part)?
            });
        }
    }
    Ok((fitted, apart))
}

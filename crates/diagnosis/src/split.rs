//! What is fitted and what is kept apart.

use super::problem::Rows;
use quell_model::Experiment;
use quell_recording::Role;
use quell_signal::{Motion, RestRule, phases};

/// Shortest part of a recording that is worth keeping apart, samples.
const FEWEST: usize = 50;

/// Rows of an experiment that are fitted, and rows that are held out, an output each.
pub struct Split {
    /// Fitted.
    pub train: Vec<Rows>,
    /// Held out.
    pub held_out: Vec<Rows>,
}

/// What was held out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeldOut {
    /// The last third of the moves.
    Moves,
    /// The last third of the time.
    End,
    /// Stretches of every move.
    Stretches,
    /// Whole recordings.
    Recordings,
}

impl HeldOut {
    /// As a sentence names it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Moves => "moves that were held out",
            Self::End => "the last third, which was held out,",
            Self::Stretches => "stretches that were held out",
            Self::Recordings => "recordings that were held out",
        }
    }
}

/// Moves up to which the time is divided, and not the moves.
const FEW_MOVES: usize = 2;

/// What [`last_third`] holds out of experiments.
pub fn last_of(experiments: &[Experiment]) -> HeldOut {
    match experiments
        .iter()
        .all(|e| move_starts(e).len() <= FEW_MOVES)
    {
        true => HeldOut::End,
        false => HeldOut::Moves,
    }
}

/// All rows are fitted.
pub fn whole(experiment: &Experiment) -> Vec<Rows> {
    let all = |output: &quell_model::Output| one(0..output.values.len());
    experiment.outputs.iter().map(all).collect()
}

fn one(range: std::ops::Range<usize>) -> Rows {
    std::iter::once(range).collect()
}

/// Keeps the last third of the moves apart; the last third of the time where there are fewer than three
/// moves.
pub fn last_third(experiment: &Experiment) -> Split {
    let (first, last) = experiment.span();
    let starts = move_starts(experiment);
    let boundary = match starts.len() {
        0..=FEW_MOVES => first + (last - first) * 2.0 / 3.0,
        n => starts[(2 * n).div_ceil(3)],
    };
    at(experiment, boundary)
}

/// Keeps apart what comes after an instant.
fn at(experiment: &Experiment, boundary: f64) -> Split {
    let (mut train, mut held_out) = (Vec::new(), Vec::new());
    for output in &experiment.outputs {
        let n = output.values.len();
        let k = output.time.partition_point(|t| *t < boundary);
        let k = if n >= 3 * FEWEST {
            k.clamp(FEWEST, n - FEWEST)
        } else {
            n
        };
        train.push(one(0..k));
        held_out.push(if k < n { one(k..n) } else { Vec::new() });
    }
    Split { train, held_out }
}

/// Every third stretch is held out, so that each part of the recording is in both: for what happens at
/// a time.
pub fn interleaved(experiment: &Experiment, stretch: f64) -> Split {
    let (mut train, mut held_out) = (Vec::new(), Vec::new());
    let (first, last) = experiment.span();
    let count = (((last - first) / stretch).floor() as usize).max(6);
    for output in &experiment.outputs {
        let (mut fitted, mut kept) = (Vec::new(), Vec::new());
        for k in 0..count {
            let edge = |k: usize| {
                let t = first + (last - first) * k as f64 / count as f64;
                output.time.partition_point(|s| *s < t)
            };
            let end = if k + 1 == count {
                output.values.len()
            } else {
                edge(k + 1)
            };
            let range = edge(k)..end;
            if k % 3 == 1 {
                kept.push(range);
            } else {
                fitted.push(range);
            }
        }
        train.push(fitted);
        held_out.push(kept);
    }
    Split { train, held_out }
}

/// Instants at which the motor side starts to move, where it is an input.
pub fn move_starts(experiment: &Experiment) -> Vec<f64> {
    if !matches!(
        experiment.input,
        Role::MotorPosition | Role::CommandPosition
    ) {
        return Vec::new();
    }
    let (time, values) = (&experiment.input_time, &experiment.input_values);
    let found = phases(time, values, RestRule::from_values(values)).unwrap_or_default();
    let moving = found.iter().filter(|phase| phase.motion == Motion::Moving);
    moving.map(|phase| phase.start).collect()
}

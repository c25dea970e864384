//! Fitted and held-out rows.

use super::problem::Rows;
use quell_model::{Experiment, Output};

/// Fitted and held-out rows of an experiment, for each output.
pub struct Split {
    /// Fitted.
    pub train: Vec<Rows>,
    /// Held out.
    pub held_out: Vec<Rows>,
}

/// The kind of held-out data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeldOut {
    /// Stretches of every recording.
    Stretches,
    /// The last windows of every recording, each with a start of its own.
    Windows,
    /// Whole recordings.
    Recordings,
}

impl HeldOut {
    /// Its name in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Stretches => "stretches that were held out",
            Self::Windows => "windows that were held out",
            Self::Recordings => "recordings that were held out",
        }
    }
}

/// All rows are fitted.
pub fn whole(experiment: &Experiment) -> Vec<Rows> {
    let all = |output: &Output| std::iter::once(0..output.values.len()).collect();
    experiment.outputs.iter().map(all).collect()
}

/// The same as a split: nothing is held out.
pub fn nothing_held_out(experiment: &Experiment) -> Split {
    Split {
        train: whole(experiment),
        held_out: vec![Vec::new(); experiment.outputs.len()],
    }
}

/// The first rows of every output are fitted.
pub fn first(experiment: &Experiment, rows: usize) -> Vec<Rows> {
    let first = |output: &Output| std::iter::once(0..rows.min(output.values.len())).collect();
    experiment.outputs.iter().map(first).collect()
}

/// Of so many stretches one is held out.
pub const EVERY: usize = 3;
/// Fewest stretches, so that each third of them covers the whole motion.
const FEWEST: usize = 6;

/// Holds out every third stretch of this length, s, from the one of this index on. All parts of a recording are then in
/// both, also an event that happens once. A stretch without a sample of an output, as of a torque that is used in motion alone,
/// is none.
pub fn interleaved(experiment: &Experiment, stretch: f64, from: usize) -> Split {
    let rows = |is_kept: bool| {
        let of = |output: &Output| {
            let all = parts(experiment, &output.time, stretch).into_iter();
            let kept = all
                .enumerate()
                .filter(|(k, rows)| (k % EVERY == from) == is_kept && !rows.is_empty());
            kept.map(|(_, rows)| rows).collect()
        };
        experiment.outputs.iter().map(of).collect()
    };
    Split {
        train: rows(false),
        held_out: rows(true),
    }
}

/// The samples with these stamps, in stretches of about this length, s, over the whole experiment.
pub fn parts(experiment: &Experiment, time: &[f64], stretch: f64) -> Rows {
    let (first, last) = experiment.span();
    let count = (((last - first) / stretch).floor() as usize).max(FEWEST);
    let inner = |k: usize| first + (last - first) * k as f64 / count as f64;
    let edge = |k: usize| match k == count {
        true => time.len(),
        false => time.partition_point(|t| *t < inner(k)),
    };
    (0..count).map(|k| edge(k)..edge(k + 1)).collect()
}

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
    /// Whole recordings.
    Recordings,
}

impl HeldOut {
    /// Its name in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Stretches => "stretches that were held out",
            Self::Recordings => "recordings that were held out",
        }
    }
}

/// All rows are fitted.
pub fn whole(experiment: &Experiment) -> Vec<Rows> {
    let all = |output: &Output| std::iter::once(0..output.values.len()).collect();
    experiment.outputs.iter().map(all).collect()
}

/// The first rows of every output are fitted.
pub fn first(experiment: &Experiment, rows: usize) -> Vec<Rows> {
    let first = |output: &Output| std::iter::once(0..rows.min(output.values.len())).collect();
    experiment.outputs.iter().map(first).collect()
}

/// Fewest stretches, so that each third of them covers the whole motion.
const FEWEST: usize = 6;

/// Holds out every third stretch of this length, s. All parts of a recording are then in both, also an event
/// that happens once.
pub fn interleaved(experiment: &Experiment, stretch: f64) -> Split {
    let (first, last) = experiment.span();
    let count = (((last - first) / stretch).floor() as usize).max(FEWEST);
    let edge = |output: &Output, k: usize| {
        let share = k as f64 / count as f64;
        let inner = || {
            output
                .time
                .partition_point(|t| *t < first + (last - first) * share)
        };
        if k == count {
            output.values.len()
        } else {
            inner()
        }
    };
    let rows = |is_kept: bool| {
        let of = |output: &Output| {
            let all = (0..count).filter(|k| (k % 3 == 1) == is_kept);
            all.map(|k| edge(output, k)..edge(output, k + 1)).collect()
        };
        experiment.outputs.iter().map(of).collect()
    };
    Split {
        train: rows(false),
        held_out: rows(true),
    }
}

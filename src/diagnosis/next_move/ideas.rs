//! Experiments that may be proposed.

use super::imagined;
use super::programme::{Pauses, candidates};
use super::seen::Seen;
use crate::diagnosis::document::ProposedMove;
use crate::diagnosis::problem::Problem;
use crate::model::Experiment;
use crate::recording::Role;

/// An experiment that was not made.
pub struct Idea {
    /// Its input and the stamps of its sensors.
    pub experiment: Experiment,
    /// Its moves; none where the input is not a motion that can be commanded.
    pub moves: Vec<ProposedMove>,
    /// How the moves follow each other, or what to do instead.
    pub manner: String,
}

/// Shares of the recorded input, never beyond it.
const SHARES: &[f64] = &[0.3, 0.5, 1.0];
/// Time constants after which 0.7 % of a vibration is left.
const SETTLED: f64 = 5.0;

impl Idea {
    /// How long it lasts, s.
    pub fn duration(&self) -> f64 {
        let (first, last) = self.experiment.span();
        last - first
    }
}

/// All that the limits seen in the recordings allow.
pub fn ideas(problem: &Problem) -> Vec<Idea> {
    let base = &problem.experiments[0];
    match base.input {
        Role::MotorPosition | Role::CommandPosition => moves(problem, base),
        _ => repetitions(base),
    }
}

fn moves(problem: &Problem, base: &Experiment) -> Vec<Idea> {
    let scales = &problem.scales;
    let Some(seen) = Seen::new(problem.experiments, scales.period()) else {
        return Vec::new();
    };
    // No longer than what was recorded in one go.
    let spans = problem.experiments.iter().map(|e| e.span().1 - e.span().0);
    let longest = spans.fold(0.0, f64::max);
    let settled = SETTLED / (scales.damping_ratio * scales.natural_frequency);
    let pauses = Pauses {
        short: scales.period().min(longest / 20.0),
        settled: settled.min(longest / 10.0),
        long: longest / 4.0,
    };
    let found = candidates(&seen, pauses, longest, &base.input_unit);
    let idea = |programme: super::programme::Programme| {
        let experiment = imagined::moved(base, &programme, &seen, pauses.short)?;
        Some(Idea {
            experiment,
            moves: programme.moves,
            manner: programme.manner,
        })
    };
    found.into_iter().filter_map(idea).collect()
}

fn repetitions(base: &Experiment) -> Vec<Idea> {
    let idea = |share: &f64| {
        Some(Idea {
            experiment: imagined::repeated(base, *share)?,
            moves: Vec::new(),
            manner: match *share {
                1.0 => "repeat the recorded input as it is".into(),
                share => format!("repeat the recorded input at {share} of its size"),
            },
        })
    };
    SHARES.iter().filter_map(idea).collect()
}

//! Experiments that may be proposed, in parts that can follow one another.

use super::imagined;
use super::programme::{Pauses, parts};
use super::seen::Seen;
use crate::document::ProposedMove;
use crate::problem::Problem;
use quell_model::Experiment;
use quell_recording::Role;

/// A part of an experiment that was not made.
pub struct Idea {
    /// Its input and the stamps of its sensors.
    pub experiment: Experiment,
    /// Its moves, which end where they start; empty if the recorded input is repeated.
    pub moves: Vec<ProposedMove>,
    /// Share of the recorded input that it repeats; 1 if there are moves.
    pub share: f64,
}

impl Idea {
    /// Number of moves of `most`; a repetition takes them all.
    pub fn moves(&self, most: usize) -> usize {
        match self.moves.len() {
            0 => most,
            count => count,
        }
    }

    /// How long it lasts, s.
    pub fn duration(&self) -> f64 {
        let (first, last) = self.experiment.span();
        last - first
    }
}

/// All parts within the limits that the recordings show.
pub struct Ideas<'a> {
    /// The parts.
    pub all: Vec<Idea>,
    /// Longest experiment, s: no longer than the longest recording.
    pub longest: f64,
    /// Most moves of an experiment; a repetition is alone.
    pub most_moves: usize,
    base: &'a Experiment,
    /// Limits, and the rest before the first move, s; `None` if there are no moves.
    moves: Option<(Seen, f64)>,
}

/// Shares of the recorded input, never beyond it.
const SHARES: &[f64] = &[0.3, 0.5, 1.0];
/// Number of time constants after which 0.7 % of a vibration is left.
const SETTLED: f64 = 5.0;
/// Most moves that a user is asked to make.
const MOST_MOVES: usize = 8;

impl<'a> Ideas<'a> {
    /// Ideas for the input of a problem's experiments.
    pub fn new(problem: &Problem<'a>) -> Self {
        let base = &problem.experiments[0];
        let spans = problem.experiments.iter().map(|e| e.span().1 - e.span().0);
        let mut ideas = Self {
            all: Vec::new(),
            // The rounding of the stamps may not matter.
            longest: spans.fold(0.0, f64::max) * (1.0 + 1e-9),
            most_moves: 1,
            base,
            moves: None,
        };
        match base.input {
            Role::MotorPosition | Role::CommandPosition => ideas.add_moves(problem),
            _ => ideas.add_repetitions(SHARES),
        }
        ideas
    }

    fn add_moves(&mut self, problem: &Problem) {
        let scales = &problem.scales;
        let Some(seen) = Seen::new(problem.experiments, scales.period()) else {
            return;
        };
        let settled = SETTLED / (scales.damping_ratio * scales.natural_frequency);
        let pauses = Pauses {
            short: scales.period().min(self.longest / 20.0),
            settled: settled.min(self.longest / 10.0),
            long: self.longest / 4.0,
        };
        self.most_moves = MOST_MOVES;
        self.moves = Some((seen, pauses.short));
        for moves in parts(&seen, pauses, &self.base.input_unit) {
            let experiment = imagined::moved(self.base, &moves, &seen, pauses.short);
            self.all.extend(experiment.map(|experiment| Idea {
                experiment,
                moves,
                share: 1.0,
            }));
        }
        // What is taken for an event comes again where a law is behind it.
        self.add_repetitions(&[1.0]);
        self.all.retain(|idea| idea.duration() <= self.longest);
    }

    fn add_repetitions(&mut self, shares: &[f64]) {
        for &share in shares {
            let experiment = imagined::repeated(self.base, share);
            self.all.extend(experiment.map(|experiment| Idea {
                experiment,
                moves: Vec::new(),
                share,
            }));
        }
    }

    /// Parts in sequence as one experiment.
    pub fn joined(&self, parts: &[usize]) -> Option<Idea> {
        let first = &self.all[*parts.first()?];
        let moves: Vec<ProposedMove> = parts
            .iter()
            .flat_map(|&part| self.all[part].moves.iter().cloned())
            .collect();
        let experiment = match &self.moves {
            Some((seen, lead)) if !moves.is_empty() => {
                imagined::moved(self.base, &moves, seen, *lead)?
            }
            _ => first.experiment.clone(),
        };
        Some(Idea {
            experiment,
            moves,
            share: first.share,
        })
    }
}

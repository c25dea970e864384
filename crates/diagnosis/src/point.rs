//! A point in the space of the unknowns: shared by all recordings, or of one recording.

use quell_model::effects::{Effect, Place};
use quell_model::{Departure, Term};

/// An effect at a place.
pub type EffectAt = (&'static Effect, Place);

/// Unknowns of one experiment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Local {
    /// Clock offset of each output, s.
    pub clocks: Vec<f64>,
    /// Departure of the start of each window.
    pub departures: Vec<Departure>,
}

/// A point in the space of unknowns.
#[derive(Clone)]
pub struct Point {
    /// Values of the kind's keys.
    pub keys: Vec<f64>,
    /// Effects with their values.
    pub terms: Vec<Term>,
    /// Effects before this one belong to the given model.
    pub given_terms: usize,
    /// Unknowns of each experiment.
    pub locals: Vec<Local>,
    /// Inertia of the link with each payload, relative to that with the first one.
    pub inertias: Vec<f64>,
    /// Unknowns that are not fitted for now.
    pub held: Vec<Global>,
}

/// A scalar unknown that all experiments share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Global {
    /// A key of the model.
    Key(usize),
    /// A parameter of an effect: term, parameter.
    Parameter(usize, usize),
    /// Inertia of the link with a payload.
    Inertia(usize),
}

impl Point {
    /// The point without a term.
    pub fn without(&self, term: usize) -> Self {
        let mut point = self.clone();
        point.terms.remove(term);
        point
    }

    /// The terms that were added to the model, as effects at places, in the order of their names.
    pub fn structure(&self) -> Vec<(&'static str, Place)> {
        let added = self.terms[self.given_terms..].iter();
        let mut all: Vec<_> = added.map(|term| (term.effect.name, term.place)).collect();
        all.sort_unstable();
        all
    }

    /// The effects that were added to the model, each once: an event may have several terms.
    pub fn effects(&self) -> Vec<EffectAt> {
        let mut effects = Vec::new();
        for term in &self.terms[self.given_terms..] {
            let effect = term.identity();
            if !effects.contains(&effect) {
                effects.push(effect);
            }
        }
        effects
    }

    /// The point without events of single recordings.
    pub fn without_what_happened(&self) -> Self {
        let mut point = self.clone();
        point.terms.retain(|term| term.recording.is_none());
        point
    }

    /// The point without an added effect.
    pub fn without_effect(&self, effect: EffectAt) -> Self {
        let mut point = self.clone();
        point.terms = self.terms[..self.given_terms].to_vec();
        let added = self.terms[self.given_terms..].iter();
        let others = added.filter(|term| term.identity() != effect);
        point.terms.extend(others.cloned());
        point
    }

    /// Takes the unknowns of each experiment from another point if it has another number of windows: the same
    /// experiments may be simulated in windows or in one piece.
    pub fn start_as(&mut self, other: &Self) {
        let windows = |point: &Self| -> Vec<usize> {
            point
                .locals
                .iter()
                .map(|own| own.departures.len())
                .collect()
        };
        if windows(self) != windows(other) {
            self.locals.clone_from(&other.locals);
        }
    }

    /// The point with one more effect.
    pub fn with(&self, term: Term) -> Self {
        let mut point = self.clone();
        point.terms.push(term);
        point
    }
}

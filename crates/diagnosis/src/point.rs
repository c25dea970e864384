//! A point in the space of the unknowns: shared by all recordings, or of one recording.

use quell_model::RESONANCES;
use quell_model::effects::{Effect, Law, Place};
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

    /// Whether the machine may have an effect beside those of the point: not a second time where it has nothing of its
    /// own, no further mode of a full chain, and at one place no law beside its own limit, or beside a learned curve of its slot
    /// that holds it.
    pub fn has_room_for(&self, (effect, place): EffectAt) -> bool {
        let added = self.terms[self.given_terms..].iter();
        let mut at_place = added.filter(|term| term.place == place);
        let limit = |own: &Effect| own.contains(effect) || effect.contains(own);
        let one_law = |own: &Effect| limit(own) || holds(own, effect) || holds(effect, own);
        let is_there = |own: &Term| own.identity() == (effect, place);
        let twice = self.terms.iter().any(is_there) && !effect.may_repeat();
        let modes = self.terms.iter().filter(|own| is_mode(own.effect));
        let is_full = is_mode(effect) && modes.count() >= RESONANCES;
        !(twice || is_full || at_place.any(|term| one_law(term.effect)))
    }

    /// The point with one more effect.
    pub fn with(&self, term: Term) -> Self {
        let mut point = self.clone();
        point.terms.push(term);
        point
    }
}

/// Whether a learned curve holds a named law: it has the same slot, and nothing of its own.
fn holds(learned: &Effect, named: &Effect) -> bool {
    let is_one = learned.slot().is_some() && learned.slot() == named.slot();
    is_one && learned.is_learned() && !named.is_learned() && !named.may_repeat()
}

/// Whether an effect is a further mode; the chain has a limited number of these.
fn is_mode(effect: &Effect) -> bool {
    matches!((effect.law)(&effect.neutral()), Law::Resonance(_))
}

//! The machine without what happened in one recording only.
//!
//! A law over time cannot tell its mean from the key that it changes: `k (1 + f(t))` is `k (1 + m)` with another `f`, and
//! the fit leaves the mean on either side. So the machine is fitted again without it; else the key would be that of a time
//! that was never recorded.

use super::point::Point;
use super::search::Search;
use super::thresholds::LONG;
use quell_model::Term;

impl Search<'_> {
    /// The point of the machine: without what happened, and fitted to the mean of what changed over time.
    pub fn machine(&self, point: &Point) -> Point {
        let changes = |term: &Term| term.recording.is_some() && term.effect.is_learned();
        let mut machine = point.clone();
        machine.terms.retain(|term| !changes(term));
        if machine.terms.len() < point.terms.len() {
            machine = self.problem.fit(&machine, self.projector, LONG).point;
        }
        machine.terms.retain(|term| term.recording.is_none());
        machine
    }
}

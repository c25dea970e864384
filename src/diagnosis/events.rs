//! Events that happen more than once: a machine that was knocked against is knocked against again.

use super::descent::Descent;
use super::explanation::Explanation;
use super::point::{Global, Point};
use super::race::SHORT;
use super::search::{STRONG, Search};
use crate::effects::recurs;

/// Steps in which the size of an event is found at the instant at which it is suspected.
const SIZE: usize = 2;

impl Search<'_> {
    /// An explanation whose last effect is an event, with further ones of its kind at the instants at which
    /// something seems to happen: each must lower the criterion as much as an effect of its own.
    pub(super) fn recurring(&self, explanation: Explanation) -> Explanation {
        let point = &explanation.fitted.point;
        let Some(event) = point.terms.last().filter(|term| recurs(term.effect.name)) else {
            return explanation;
        };
        let suspects = &self.problem.scales.suspects;
        let (effect, place) = (event.effect, event.place);
        let mut best = explanation.clone();
        for &time in suspects {
            let point = &best.fitted.point;
            let own = point
                .terms
                .iter()
                .filter(|term| term.effect.name == effect.name);
            let apart = |at: f64| (at - time).abs() > self.problem.scales.period();
            // Its size comes first among an event's parameters, its time last.
            if own
                .filter_map(|term| term.values.last())
                .any(|at| !apart(*at))
            {
                continue;
            }
            let mut values = effect.neutral();
            values.pop();
            values.push(time);
            let next = self.with_event(&point.with(effect, place, values));
            let looks = 2.0 * (suspects.len() as f64).ln();
            if self.criterion(&next) < self.criterion(&best) - (STRONG + looks) * self.unit(&next) {
                best = next;
            }
        }
        match best.fitted.point.terms.len() > explanation.fitted.point.terms.len() {
            true => self.refitted(&best.fitted.point),
            false => explanation,
        }
    }

    /// A structure whose last term is an event: its size first, then all.
    fn with_event(&self, point: &Point) -> Explanation {
        let mut held = point.clone();
        let term = point.terms.len() - 1;
        let last = point.terms[term].values.len() - 1;
        held.held = vec![Global::Parameter(term, last)];
        let fitted = |point: &Point, steps| {
            let mut descent = Descent::new(self.problem, self.projector, point, None);
            descent.run(steps);
            descent.end()
        };
        let mut sized = fitted(&held, SIZE).point;
        sized.held.clear();
        self.judge.judge(self.problem, fitted(&sized, SHORT))
    }
}

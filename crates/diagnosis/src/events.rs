//! Events that happen more than once, such as repeated impacts.

use super::descent::Descent;
use super::evidence::CALIBRATED;
use super::explanation::Explanation;
use super::fit::Linearised;
use super::point::{Global, Point};
use super::search::Search;
use super::thresholds::SHORT;
use quell_model::Term;
use std::cmp::Ordering;

impl Search<'_> {
    /// An explanation whose last effect is an event, plus further events of its kind at candidate instants.
    /// Each must raise the evidence.
    pub(super) fn recurring(&self, explanation: Explanation) -> Explanation {
        let point = &explanation.fitted.point;
        let last = point.terms.last();
        let Some((event, when)) = last.and_then(|term| Some((term, term.effect.event_time()?)))
        else {
            return explanation;
        };
        let each = self.problem.scales_of_each.iter();
        let candidates = each.flat_map(|(own, scales)| {
            let times = scales.candidate_events.iter();
            times.map(|time| (*own, *time))
        });
        let temperature = CALIBRATED * self.judge.unit(&explanation);
        let mut best = explanation.clone();
        let mut known = None;
        for (recording, time) in candidates.take_while(|_| !self.problem.is_cut()) {
            let point = &best.fitted.point;
            let here = |term: &&Term| is_like(term, event) && term.recording == Some(recording);
            let own = point.terms.iter().filter(here);
            let mut times = own.map(|term| term.values[when]);
            if times.any(|own| (own - time).abs() <= self.problem.scales.period()) {
                continue;
            }
            let mut next = event.clone().in_recording(Some(recording));
            next.values = event.effect.neutral();
            next.values[when] = time;
            let slopes = known.get_or_insert_with(|| self.problem.linearise(point, self.projector));
            let Some(sized) = self.sized(&point.with(next), slopes, temperature) else {
                continue;
            };
            let fitted = self.problem.fit(&sized, self.projector, SHORT);
            let next = self.judge.judge(self.problem, self.projector, fitted);
            if next.log_evidence(temperature) > best.log_evidence(temperature) {
                best = next;
                known = None;
            }
        }
        match best.fitted.point.terms.len() > point.terms.len() {
            true => self.together(best, (event, when), temperature),
            false => explanation,
        }
    }

    /// Events in the order of their times, fitted together, without those that are not needed beside the
    /// others.
    fn together(
        &self,
        found: Explanation,
        (event, when): (&Term, usize),
        temperature: f64,
    ) -> Explanation {
        let mut point = found.fitted.point;
        let mut added = point.terms.split_off(point.given_terms);
        let time = |term: &Term| is_like(term, event).then(|| (term.recording, term.values[when]));
        let order = |a: &Term, b: &Term| time(a).partial_cmp(&time(b));
        added.sort_by(|a, b| order(a, b).unwrap_or(Ordering::Equal));
        point.terms.append(&mut added);
        let mut best = self.refitted(&point);
        loop {
            let point = &best.fitted.point;
            let events = (point.given_terms..point.terms.len())
                .filter(|&term| is_like(&point.terms[term], event));
            let events: Vec<usize> = events.collect();
            if events.len() < 2 {
                return best;
            }
            let without: Vec<Explanation> = events
                .into_iter()
                .map(|term| self.refitted(&point.without(term)))
                .collect();
            let log = |own: &Explanation| own.log_evidence(temperature);
            let next = without.into_iter().max_by(|a, b| log(a).total_cmp(&log(b)));
            match next.filter(|next| log(next) >= log(&best)) {
                Some(next) => best = next,
                None => return best,
            }
        }
    }

    /// A point whose last term is an event, with its size from one step while all else is known. `None` where
    /// its expected gain does not exceed the prior odds of an effect.
    fn sized(&self, point: &Point, known: &Linearised, temperature: f64) -> Option<Point> {
        let last = point.terms.len() - 1;
        let when = point.terms[last].effect.event_time()?;
        let mut held = point.clone();
        held.held = vec![Global::Parameter(last, when)];
        let mut descent = Descent::new(self.problem, self.projector, &held, Some(known));
        descent.glance();
        let worth = -2.0 * temperature * self.problem.log_prior_of_one();
        let promises = known.cost - descent.cost() > worth;
        let mut sized = descent.end().point;
        sized.held.clear();
        promises.then_some(sized)
    }
}

/// Whether two terms are the same effect at the same place.
fn is_like(own: &Term, other: &Term) -> bool {
    own.identity() == other.identity()
}

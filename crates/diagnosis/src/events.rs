//! Effects that act more than once: repeated impacts, a vibration from outside in several recordings.

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
    /// An explanation whose last effect is one that recurs, plus further ones of its kind: events at candidate
    /// instants, what lasts through a recording in the other recordings. Each must raise the evidence.
    pub(super) fn recurring(&self, explanation: Explanation) -> Explanation {
        let point = &explanation.fitted.point;
        let last = point.terms.last();
        let Some(event) = last.filter(|term| term.effect.recurs()) else {
            return explanation;
        };
        let occasions = self.occasions(event);
        if occasions.is_empty() {
            return explanation;
        }
        let temperature = CALIBRATED * self.judge.unit(&explanation);
        // What happens between two fitted stretches is seen in the held-out ones only.
        let whole = self.all_rows();
        let all = whole.as_ref().map_or(*self, |own| own.search(self));
        let mut best = explanation.clone();
        let mut known = None;
        for starts in occasions {
            let point = &best.fitted.point;
            if self.problem.is_cut() {
                break;
            }
            if self.is_there(point, &starts[0]) {
                continue;
            }
            let slopes = known.get_or_insert_with(|| all.problem.linearise(point, all.projector));
            let Some(sized) = all.sized(point, &starts, slopes, temperature) else {
                continue;
            };
            let sized = all.problem.fit(&sized, all.projector, SHORT).point;
            let fitted = self.problem.fit(&sized, self.projector, SHORT);
            let next = self.judge.judge(self.problem, self.projector, fitted);
            if next.log_evidence(temperature) > best.log_evidence(temperature) {
                best = next;
                known = None;
            }
        }
        match best.fitted.point.terms.len() > point.terms.len() {
            true => self.together(best, event, temperature),
            false => explanation,
        }
    }

    /// Where another one of an effect may be, each with the values to start from.
    fn occasions(&self, event: &Term) -> Vec<Vec<Term>> {
        let mut all = Vec::new();
        for (own, scales) in &self.problem.scales_of_each {
            let with =
                |values| Term::new(event.effect, event.place, values).in_recording(Some(*own));
            match event.effect.event_time() {
                Some(when) => all.extend(scales.candidate_events.iter().map(|time| {
                    let mut values = event.values.clone();
                    let size = event.effect.size();
                    values[size] = event.effect.parameters[size].neutral;
                    values[when] = *time;
                    vec![with(values)]
                })),
                None => {
                    let starts = event.effect.starts_at(event.place, scales);
                    all.push(starts.into_iter().map(with).collect());
                }
            }
        }
        all.retain(|starts: &Vec<Term>| !starts.is_empty());
        all
    }

    /// Whether a point has an effect at this occasion: in this recording, events within a period of the mode.
    fn is_there(&self, point: &Point, one: &Term) -> bool {
        let here = |term: &&Term| is_like(term, one) && term.recording == one.recording;
        let mut own = point.terms.iter().filter(here);
        own.any(|term| {
            let apart = |when: usize| (term.values[when] - one.values[when]).abs();
            let apart = one.effect.event_time().map_or(0.0, apart);
            apart <= self.problem.scales.period()
        })
    }

    /// Events in the order of their times, fitted together, without those that are not needed beside the
    /// others.
    fn together(&self, found: Explanation, event: &Term, temperature: f64) -> Explanation {
        let mut point = found.fitted.point;
        let mut added = point.terms.split_off(point.given_terms);
        let when = event.effect.event_time();
        let time = |term: &Term| {
            let time = || when.map(|when| term.values[when]);
            is_like(term, event).then(|| (term.recording, time()))
        };
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

    /// A point with one term more: from the best of its starts, sized by one step while all else is known. `None` where
    /// its expected gain does not exceed the prior odds of an effect.
    fn sized(
        &self,
        point: &Point,
        starts: &[Term],
        known: &Linearised,
        temperature: f64,
    ) -> Option<Point> {
        let from = |start: &Term| {
            let mut held = point.with(start.clone());
            let when = start.effect.event_time().into_iter();
            held.held = when
                .map(|when| Global::Parameter(point.terms.len(), when))
                .collect();
            let mut descent = Descent::new(self.problem, self.projector, &held, Some(known));
            descent.glance();
            descent
        };
        let steps = starts.iter().map(from);
        let best = steps.min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
        let worth = -2.0 * temperature * self.problem.log_prior_of_one();
        let promises = known.cost - best.cost() > worth;
        let mut sized = best.end().point;
        sized.held.clear();
        promises.then_some(sized)
    }
}

/// Whether two terms are the same effect at the same place.
fn is_like(own: &Term, other: &Term) -> bool {
    own.identity() == other.identity()
}

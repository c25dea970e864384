//! Laws with and without the parameters that they may be without: the duration of a knock, the Stribeck curve of bristles.
//!
//! Candidates are screened without them, where there is an accelerometer also with them. A law is fitted with them, from typical
//! values, when it is a new one, and again in the best explanation, where other laws no longer hide them.

use super::evidence::CALIBRATED;
use super::explanation::Explanation;
use super::point::Point;
use super::problem::Problem;
use super::search::Search;
use super::thresholds::BARE_MENTION;
use quell_model::Term;

impl Search<'_> {
    /// An explanation with the parameters that those of its laws may be without which `are_meant`, where these raise the evidence.
    pub(super) fn in_full(
        &self,
        own: Explanation,
        are_meant: impl Fn(&Term) -> bool,
    ) -> Explanation {
        let fuller = self.problem.fuller(&own.fitted.point, are_meant);
        let Some((all, parts)) = fuller.split_first().filter(|_| !self.problem.is_cut()) else {
            return own;
        };
        // Where a mismatch is left, its size and correlation say what a further parameter is worth.
        let temperature = CALIBRATED * self.judge.unit(&own) * own.evidence.correlation();
        let log = |own: &Explanation| own.log_evidence(temperature);
        let all = self.fitted_to_all_rows(all);
        if log(&all) <= log(&own) {
            return own;
        }
        // What makes unseen rows worse is not told, as an effect that does is not.
        let holds = |next: &Explanation| {
            let worse = next.missed(temperature) - own.missed(temperature);
            next.at_end.is_none() && log(next) > log(&own) && worse <= BARE_MENTION
        };
        let parts = parts.iter().map(|point| self.fitted_to_all_rows(point));
        let known = parts.chain([all]).filter(holds);
        let best = known.max_by(|a, b| log(a).total_cmp(&log(b)));
        best.unwrap_or(own)
    }
}

impl Problem<'_> {
    /// Points whose added laws that `are_meant` have parameters that they are without: all of them, then those that go together.
    fn fuller(&self, point: &Point, are_meant: impl Fn(&Term) -> bool) -> Vec<Point> {
        let laws = |own: &Term| match are_meant(own) {
            true => own.effect.fuller(&own.values, &self.scales),
            false => Vec::new(),
        };
        let laws: Vec<_> = point.terms[point.given_terms..].iter().map(laws).collect();
        let most = laws.iter().map(Vec::len).max().unwrap_or(0);
        let with = |count: usize| {
            let mut next = point.clone();
            for (own, laws) in next.terms[point.given_terms..].iter_mut().zip(&laws) {
                if let Some(values) = laws.get(count).or(laws.last()) {
                    own.values.clone_from(values);
                }
            }
            next
        };
        (0..most).map(with).collect()
    }

    /// A point whose added laws are without all parameters that they may be without; `None` where they are.
    pub(super) fn simpler(&self, point: &Point) -> Option<Point> {
        let mut next = point.clone();
        let mut is_other = false;
        for own in &mut next.terms[point.given_terms..] {
            if let Some(values) = own.effect.simpler(&own.values) {
                (own.values, is_other) = (values, true);
            }
        }
        is_other.then_some(next)
    }
}

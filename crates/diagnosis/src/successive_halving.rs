//! Successive halving of candidates: each is fitted only as long as it may still win.
//!
//! Source: Jamieson and Talwalkar, AISTATS 2016, for the halving of starts.

use super::candidate::Candidate;
use super::descent::Descent;
use super::explanation::Explanation;
use super::fit::Linearised;
use super::point::{EffectAt, Point};
use super::pool::Pool;
use super::search::Search;
use super::thresholds::{LONG, LOST, SECOND, SHORT};
use quell_model::Term;
use rayon::prelude::*;

/// Share of the winner's fall of the cost that another candidate must have reached to be fitted further.
const NEARER: f64 = 0.5;

/// Candidates that are fitted to convergence.
pub(super) const HALF: usize = 5;

/// Candidates on top of an explanation, with the state of their fits.
pub(super) struct Halving<'a> {
    search: &'a Search<'a>,
    from: &'a Explanation,
    /// Linearisation at that explanation.
    linear: Option<&'a Linearised>,
    entrants: Vec<Entrant<'a>>,
    leader: Option<Explanation>,
    /// Cost of an explanation of no more effects that is known and leaves nothing but noise.
    known: Option<f64>,
}

/// A candidate with its fits.
struct Entrant<'a> {
    effect: EffectAt,
    /// Fits from its starts, the best first.
    starts: Vec<Descent<'a>>,
}

impl Entrant<'_> {
    fn cost(&self) -> f64 {
        self.starts.first().map_or(f64::INFINITY, Descent::cost)
    }
}

impl<'a> Halving<'a> {
    /// A halving without entrants. No further effect is credible that does not come near a known explanation of no more effects
    /// that leaves nothing but noise.
    pub fn new(
        search: &'a Search<'a>,
        from: &'a Explanation,
        linear: Option<&'a Linearised>,
        pool: &Pool,
    ) -> Self {
        let best = pool.best(search.judge);
        let is_rival = search.leaves_noise(best) && best.terms() <= from.terms() + 1;
        Self {
            search,
            from,
            linear,
            entrants: Vec::new(),
            leader: None,
            known: is_rival.then_some(best.fitted.cost),
        }
    }

    /// Adds candidates; each makes its first step.
    pub fn enter(&mut self, candidates: Vec<Candidate>) {
        let entrants = candidates.into_par_iter().map(|own| self.started(own));
        for mut next in entrants.collect::<Vec<_>>() {
            match self
                .entrants
                .iter_mut()
                .find(|own| own.effect == next.effect)
            {
                Some(own) => {
                    own.starts.append(&mut next.starts);
                    own.starts.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
                }
                None => self.entrants.push(next),
            }
        }
    }

    fn started(&self, candidate: Candidate) -> Entrant<'a> {
        let Search {
            problem, projector, ..
        } = *self.search;
        let start = |point: &Point, near| {
            let mut descent = Descent::new(problem, projector, point, near);
            descent.glance();
            descent
        };
        let near = candidate.near.iter().map(|point| start(point, self.linear));
        let far = candidate.far.iter().map(|point| start(point, None));
        let all = near.chain(far).take_while(|_| !problem.is_cut());
        let mut starts: Vec<Descent> = all.collect();
        starts.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        Entrant {
            effect: candidate.effect,
            starts,
        }
    }

    /// Fits the leading candidate first, to convergence or until it cannot reach `rival` any more. Effects with
    /// many minima are excluded: some of their starts may follow later.
    pub fn lead(&mut self, rival: f64) {
        let plain = |index: &usize| !self.entrants[*index].effect.0.has_many_minima();
        let cost = |index: &usize| self.entrants[*index].cost();
        let all = (0..self.entrants.len()).filter(plain);
        if let Some(first) = all.min_by(|a, b| cost(a).total_cmp(&cost(b))) {
            let entrant = self.entrants.remove(first);
            let rival = rival.min(self.ahead());
            let chosen = self.chosen(entrant, rival);
            self.leader = chosen.and_then(|descent| self.carried(descent, rival));
        }
    }

    /// Whether the leader, or a known explanation, leaves nothing but noise.
    pub fn is_won(&self) -> bool {
        self.winner().is_some()
    }

    /// Whether an effect takes part.
    pub fn has(&self, effect: EffectAt) -> bool {
        self.entrants.iter().any(|entrant| entrant.effect == effect)
    }

    /// Fits all candidates to convergence, or until they cannot win any more, and judges them.
    pub fn finish(mut self) -> Vec<Explanation> {
        let mut entrants = std::mem::take(&mut self.entrants);
        let winner = self.winner().unwrap_or(f64::INFINITY);
        let chosen_of = |entrants: Vec<Entrant<'a>>, rival| -> Vec<Descent<'a>> {
            let chosen = entrants.into_par_iter();
            chosen
                .filter_map(|entrant| self.chosen(entrant, rival))
                .collect()
        };
        entrants.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        let behind = entrants.split_off(HALF.min(entrants.len()));
        let mut chosen = chosen_of(entrants, winner);
        // A candidate behind must beat the last of these.
        let last = chosen.iter().map(Descent::cost);
        let last = last.fold(f64::NEG_INFINITY, f64::max);
        let rival = if chosen.len() < HALF {
            winner
        } else {
            last.min(winner)
        };
        chosen.extend(chosen_of(behind, rival));
        chosen.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        chosen.truncate(HALF);
        let costs = chosen.iter().map(Descent::cost);
        let ahead = costs.fold(self.ahead(), f64::min);
        let trials = chosen
            .into_par_iter()
            .filter_map(|descent| self.carried(descent, ahead));
        let mut trials: Vec<Explanation> = trials.collect();
        trials.extend(self.leader);
        trials
    }

    /// Least cost of the leader and of the known explanation, of those that leave nothing but noise.
    fn winner(&self) -> Option<f64> {
        let leader = self.leader.as_ref();
        let leader = leader.filter(|own| self.search.leaves_noise(own));
        let costs = leader.map(|own| own.fitted.cost).into_iter();
        costs.chain(self.known).min_by(f64::total_cmp)
    }

    /// Least cost of the leader and of the known explanation.
    fn ahead(&self) -> f64 {
        let leader = self.leader.as_ref().map(|own| own.fitted.cost);
        let costs = leader.into_iter().chain(self.known);
        costs.fold(f64::INFINITY, f64::min)
    }

    /// The best of a candidate's starts, fitted towards `rival`.
    fn chosen(&self, mut entrant: Entrant<'a>, rival: f64) -> Option<Descent<'a>> {
        let mut ahead = rival;
        for descent in entrant.starts.iter_mut().take(SECOND) {
            descent.run_against(SHORT, ahead);
            ahead = ahead.min(descent.cost());
        }
        let best = entrant.starts.into_iter();
        let best = best.min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
        (best.cost() <= self.from.fitted.cost).then_some(best)
    }

    /// A fit carried to convergence, or until it cannot reach the one ahead any more; judged. `None` where it is not near a known
    /// explanation.
    fn carried(&self, mut descent: Descent<'a>, ahead: f64) -> Option<Explanation> {
        let explained = |cost: f64| self.from.fitted.cost - cost;
        let near = |winner| explained(descent.cost()) > NEARER * explained(winner);
        let carries = self.winner().is_none_or(near);
        if carries {
            descent.run_against(LONG, ahead);
            if descent.winds() && descent.cost() < LOST * ahead {
                descent.hop(ahead);
            }
        }
        if !carries && self.known.is_some() {
            return None;
        }
        let Search {
            problem,
            projector,
            judge,
            ..
        } = self.search;
        let explanation = judge.judge(problem, projector, descent.end());
        let new = explanation.fitted.point.terms.last().map(Term::identity);
        Some(match carries {
            true => {
                let all = self.search.recurring(explanation);
                let is_new = |own: &Term| Some(own.identity()) == new;
                self.search.in_full(all, is_new)
            }
            false => explanation,
        })
    }
}

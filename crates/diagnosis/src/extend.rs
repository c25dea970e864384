//! Candidates on top of an explanation: screened, fitted by successive halving, and ranked.

use super::candidate::Candidate;
use super::criteria::{Search, ratio, sort};
use super::explanation::Explanation;
use super::fit::Linearised;
use super::found::Trial;
use super::point::{EffectAt, Point};
use super::screen::{Start, screen};
use super::successive_halving::Halving;
use super::thresholds::{GATE, STRONG};

/// Candidates that are fitted after the screen.
const FITTED: usize = 10;
/// Sizes of each candidate that a fit starts from: a law with a time or a length has a basin for each few of them.
const SIZES: usize = 4;
/// Predicted fall of the cost below which a candidate is not fitted.
const HOPELESS: f64 = 6.0;

impl Search<'_> {
    /// Candidates on top of an explanation, fitted and judged against it; best first.
    pub fn extend(&self, from: &Explanation) -> Vec<Trial> {
        let (problem, projector) = (self.problem, self.projector);
        let linear = (!self.known.alone).then(|| problem.linearise(&from.fitted.point, projector));
        let mut found = Vec::new();
        if let Some(linear) = &linear {
            found = self.screened(from, linear);
        }
        self.add_known(from, &mut found);
        let mut halving = Halving::new(self, from, linear.as_ref());
        halving.enter(found);
        halving.lead();
        let continued = self.continued(from, &halving);
        halving.enter(continued);
        let mut trials = halving.finish();
        self.rank(from, &mut trials);
        trials
    }

    /// The best candidates of a screen.
    fn screened(&self, from: &Explanation, linear: &Linearised) -> Vec<Candidate> {
        let (problem, point) = (self.problem, &from.fitted.point);
        // A mismatch that the refitted keys have absorbed is found from what the engineer believes.
        let mut believed = point.clone();
        for &key in &problem.free {
            believed.keys[key] = problem.beliefs[key].0;
        }
        let starts = screen(problem, point, linear, self.projector, SIZES);
        let candidate = |starts: Vec<Start>| {
            let with = |from: &Point, s: &Start| from.with(s.effect, s.place, s.values.clone());
            let near = starts.iter().map(|start| with(point, start));
            let near = near.chain([with(&believed, &starts[0])]);
            Candidate {
                effect: (starts[0].effect, starts[0].place),
                near: near.collect(),
                far: Vec::new(),
            }
        };
        chosen(starts).into_iter().map(candidate).collect()
    }

    /// What is known with one effect more than the explanation has.
    fn add_known(&self, from: &Explanation, found: &mut Vec<Candidate>) {
        let own = from.effects();
        for known in &self.known.points {
            let theirs = known.effects();
            let new: Vec<_> = theirs.iter().filter(|e| !own.contains(e)).collect();
            let &[&effect] = new.as_slice() else { continue };
            if theirs.len() != own.len() + 1 {
                continue;
            }
            // The new effect comes last, as on top of an explanation.
            let mut point = known.without_effect(effect);
            let terms = known.terms[known.given_terms..].iter();
            let last = terms.filter(|term| term.identity() == effect);
            point.terms.extend(last.cloned());
            point.start_as(&from.fitted.point);
            add_far(found, effect, vec![point]);
        }
    }

    /// Judges fits against the explanation that they extend; best first.
    pub(super) fn rank(&self, from: &Explanation, trials: &mut [Trial]) {
        let unit = trials
            .iter()
            .map(|trial| self.unit(&trial.explanation))
            .fold(self.unit(from), f64::min);
        for trial in trials.iter_mut() {
            let change = self.criterion(&trial.explanation) - self.criterion(from);
            trial.delta_bic = change / unit;
            trial.held_out_ratio = ratio(trial.explanation.held_out, from.held_out);
            // As many sizes as were looked at, so many chances had noise (a Bonferroni bound on 2 ln L).
            let looks = trial.explanation.looks(&self.problem.scales) as f64;
            let certain = trial.delta_bic < -STRONG - 2.0 * looks.ln();
            trial.passed = certain && trial.held_out_ratio < GATE;
        }
        sort(trials);
        trials.iter().for_each(|trial| self.log(trial));
    }

    /// For who wants to follow the search.
    fn log(&self, trial: &Trial) {
        let own = &trial.explanation;
        let over_noise = |chi: f64, rows: usize| (chi / rows.max(1) as f64).sqrt();
        let terms = own.fitted.point.terms.iter();
        let values: Vec<&[f64]> = terms.map(|term| &term.values[..]).collect();
        tracing::debug!(
            effects = ?own.effects(),
            ?values,
            keys = ?own.fitted.point.keys,
            delta_bic = trial.delta_bic,
            held_out_ratio = trial.held_out_ratio,
            passed = trial.passed,
            fitted_over_noise = over_noise(own.train, self.judge.train_rows),
            held_out_over_noise = over_noise(own.held_out, self.judge.held_out_rows),
            "candidate"
        );
    }
}

/// Adds starts elsewhere to those of an effect.
fn add_far(found: &mut Vec<Candidate>, effect: EffectAt, mut far: Vec<Point>) {
    match found
        .iter_mut()
        .find(|candidate| candidate.effect == effect)
    {
        Some(candidate) => candidate.far.append(&mut far),
        None => found.push(Candidate {
            effect,
            near: Vec::new(),
            far,
        }),
    }
}

/// Starts of the best candidates, those of one effect and place together.
fn chosen(starts: Vec<Start>) -> Vec<Vec<Start>> {
    let mut groups: Vec<Vec<Start>> = Vec::new();
    for start in starts {
        if start.score < HOPELESS {
            break;
        }
        let same = |group: &&mut Vec<Start>| {
            (group[0].effect, group[0].place) == (start.effect, start.place)
        };
        let room = groups.len() < FITTED;
        match groups.iter_mut().find(same) {
            Some(group) => group.push(start),
            None if room => groups.push(vec![start]),
            None => {}
        }
    }
    groups
}

//! The search for what is missing: screen, fit, decide; once more on the better model; prune.

use super::descent::Descent;
use super::explanation::{Explanation, Judge};
use super::fit::{Linearised, Projector};
use super::problem::{Point, Problem};
use super::screen::{Start, screen};
use crate::effects::{Place, contains};
use rayon::prelude::*;

/// Bayesian information criterion by which an effect must be better to be named: 10 is "very strong"
/// (Kass and Raftery, J. American Statistical Association 90 (1995)).
pub const STRONG: f64 = 10.0;
/// Held-out chi-squared of an effect over that without it, above which it is not believed.
pub const GATE: f64 = 0.98;
/// The same where the model alone is already at the floor: a part of the noise that is no larger than the
/// uncertainty of its level (a twentieth in amplitude) is not called physics.
const WEAK: f64 = 0.9;
/// Explanations within this of the best cannot be told from it.
pub const EQUAL: f64 = 15.0;
/// Chi-squared per row up to which a residual is noise: its level is known within a tenth.
pub const FLOOR: f64 = 1.21;
/// Candidates that are fitted after the screen.
const FITTED: usize = 10;
/// Sizes of each candidate that a fit starts from.
const SIZES: usize = 3;
/// Steps after which the better ones of these go on (successive halving: Jamieson and Talwalkar,
/// AISTATS 2016).
const FIRST: usize = 2;
/// How many go on.
const SECOND: usize = 2;
/// Steps after which the best of these is chosen.
const SHORT: usize = 3;
/// Most steps of the fit that is carried through.
const LONG: usize = 25;
/// Predicted fall of the cost below which a candidate is not fitted.
const HOPELESS: f64 = 6.0;
/// Most effects in one explanation: with three the structure is no longer determined by a recording.
const MOST_EFFECTS: usize = 2;
/// Share of the mismatch that may be left: no law of a catalogue has nature's shape to better than a
/// tenth in amplitude (friction is regular, contact compliant), a hundredth in energy.
pub const SHAPE: f64 = 0.01;
/// Explanations that are carried on.
const BEAM: usize = 2;

/// A candidate that was fitted, against the model without it.
#[derive(Clone)]
pub struct Trial {
    /// The explanation.
    pub explanation: Explanation,
    /// Difference of the criterion to the baseline, in units of what noise leaves.
    pub delta_bic: f64,
    /// Held-out chi-squared over the baseline's.
    pub held_out_ratio: f64,
    /// Whether it passed both gates against the explanation that it extends.
    pub passed: bool,
}

/// What the search found.
pub struct Found {
    /// The refitted model.
    pub baseline: Explanation,
    /// The best explanation; the baseline where nothing passed.
    pub best: Explanation,
    /// Explanations that are as good.
    pub equals: Vec<Trial>,
    /// All single effects that were fitted, best first.
    pub trials: Vec<Trial>,
    /// Chi-squared per row that the best one leaves, at least 1.
    pub unit: f64,
    /// The best one without each of its effects, refitted.
    pub ablated: Vec<Explanation>,
}

impl Found {
    /// The best explanation without one of its terms.
    pub fn without(&self, term: usize) -> &Explanation {
        let index = term - self.best.fitted.point.given_terms;
        self.ablated.get(index).unwrap_or(&self.baseline)
    }
}

/// Everything that the search needs.
pub struct Search<'a> {
    /// The problem.
    pub problem: &'a Problem<'a>,
    /// Projects its nuisances out.
    pub projector: &'a Projector,
    /// Judges its fits.
    pub judge: &'a Judge<'a>,
    /// Told how far the work is, 0 to 1, and what is being done.
    pub progress: &'a (dyn Fn(f64, &str) + Sync),
}

impl Search<'_> {
    /// Searches from the refitted model on.
    pub fn run(&self, baseline: Explanation) -> Found {
        let mut trials = self.extend(&baseline, FITTED);
        if self.at_floor(&baseline) {
            trials
                .iter_mut()
                .for_each(|trial| trial.passed &= trial.held_out_ratio < WEAK);
        }
        let mut frontier: Vec<Explanation> = passed(&trials, BEAM);
        let mut best = self
            .simplest(&trials, &baseline)
            .unwrap_or_else(|| baseline.clone());
        if !frontier.is_empty() && frontier[0].effects() != best.effects() {
            frontier.insert(0, best.clone());
            frontier.truncate(BEAM);
        }
        let mut pool = trials.clone();
        for depth in 1..MOST_EFFECTS {
            if frontier.is_empty() || self.explains(&baseline, &best) {
                break;
            }
            (self.progress)(0.3 + 0.2 * depth as f64, "looking for a further effect");
            let further: Vec<Trial> = frontier
                .iter()
                .flat_map(|explanation| self.extend(explanation, FITTED))
                .collect();
            let mut next = further.clone();
            sort(&mut next);
            frontier = passed(&next, BEAM);
            let Some(first) = frontier.first() else { break };
            let pruned = self.prune(first.clone());
            // What is left of the mismatch falls by more than the shape of a law could be wrong.
            let worth =
                best.train - pruned.train > SHAPE * (baseline.train - self.judge.train_rows as f64);
            if worth
                && self.criterion(&pruned) < self.criterion(&best) - STRONG * self.unit(&pruned)
            {
                best = pruned;
            }
            pool.extend(further);
        }
        let unit = self.unit(&best);
        for trial in trials.iter_mut().chain(&mut pool) {
            let change = self.criterion(&trial.explanation) - self.criterion(&baseline);
            trial.delta_bic = change / unit;
            trial.held_out_ratio = ratio(trial.explanation.held_out, baseline.held_out);
        }
        let equals = self.equals(&best, &pool, unit);
        sort(&mut trials);
        let ablated = self.ablated(&best, &baseline);
        Found {
            ablated,
            baseline,
            best,
            equals,
            trials,
            unit,
        }
    }

    /// Candidates on top of an explanation, fitted and judged against it; best first.
    pub fn extend(&self, from: &Explanation, count: usize) -> Vec<Trial> {
        let (problem, projector) = (self.problem, self.projector);
        let linear = problem.linearise(&from.fitted.point, projector);
        let starts = screen(problem, &from.fitted.point, &linear, projector, SIZES);
        let mut trials: Vec<Trial> = chosen(starts, count)
            .into_par_iter()
            .filter_map(|starts| self.fit(from, &linear, &starts))
            .collect();
        let unit = trials
            .iter()
            .map(|trial| self.unit(&trial.explanation))
            .fold(self.unit(from), f64::min);
        for trial in &mut trials {
            let change = self.criterion(&trial.explanation) - self.criterion(from);
            trial.delta_bic = change / unit;
            trial.held_out_ratio = ratio(trial.explanation.held_out, from.held_out);
            trial.passed = trial.delta_bic < -STRONG && trial.held_out_ratio < GATE;
        }
        sort(&mut trials);
        trials
    }

    /// The best of a candidate's starts, fitted to its end.
    fn fit(&self, from: &Explanation, linear: &Linearised, starts: &[Start]) -> Option<Trial> {
        let (problem, projector) = (self.problem, self.projector);
        // A mismatch that the refitted keys have absorbed is found from what the engineer believes.
        let mut believed = from.fitted.point.clone();
        for &key in &problem.free {
            believed.keys[key] = problem.beliefs[key].0;
        }
        let begin = |(start, point): (&Start, &Point)| {
            let point = point.with(start.effect, start.place, start.values.clone());
            let mut descent = Descent::new(problem, projector, &point, Some(linear));
            descent.run(FIRST);
            descent
        };
        let starts = starts
            .iter()
            .flat_map(|start| [(start, &from.fitted.point), (start, &believed)]);
        let mut descents: Vec<Descent> = starts.map(begin).collect();
        descents.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
        descents.truncate(SECOND);
        descents.iter_mut().for_each(|descent| descent.run(SHORT));
        let best = descents.into_iter();
        let mut best = best.min_by(|a, b| a.cost().total_cmp(&b.cost()))?;
        if best.cost() > from.fitted.cost {
            return None;
        }
        best.run(LONG);
        let fitted = best.end();
        let explanation = self.judge.judge(problem, projector, fitted);
        Some(Trial {
            explanation,
            delta_bic: 0.0,
            held_out_ratio: 1.0,
            passed: false,
        })
    }

    /// `chi^2 + k ln N`.
    pub fn criterion(&self, explanation: &Explanation) -> f64 {
        let n = self.judge.train_rows as f64;
        explanation.fitted.cost + explanation.unknowns() as f64 * n.ln()
    }

    /// Chi-squared per row, at least 1: what the best model leaves is the unit of evidence.
    pub fn unit(&self, explanation: &Explanation) -> f64 {
        (explanation.train / self.judge.train_rows as f64).max(1.0)
    }

    /// Whether nothing but noise is left.
    pub fn at_floor(&self, explanation: &Explanation) -> bool {
        explanation.train <= FLOOR * self.judge.train_rows as f64
    }

    /// Whether nothing but noise, or the hundredth part of the mismatch, is left.
    pub fn explains(&self, baseline: &Explanation, explanation: &Explanation) -> bool {
        let rows = self.judge.train_rows as f64;
        let (left, mismatch) = (explanation.train - rows, baseline.train - rows);
        // Fitted and held-out part together: what holds on moves that were never seen is not undone by a
        // few instants of the others.
        let all = rows + self.judge.held_out_rows as f64;
        let pooled = explanation.train + explanation.held_out <= FLOOR * all;
        self.at_floor(explanation) || pooled || left < SHAPE * mismatch
    }

    /// The best trial that passed; or one whose law is a limit of the best one's, if they differ by less
    /// than a law's shape could be wrong.
    fn simplest(&self, trials: &[Trial], baseline: &Explanation) -> Option<Explanation> {
        let sound = || {
            trials
                .iter()
                .filter(|trial| trial.passed)
                .map(|trial| &trial.explanation)
        };
        let best = sound().min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)))?;
        let reach = SHAPE * (baseline.train - self.judge.train_rows as f64).max(0.0);
        let simpler = sound().find(|other| {
            let names = (best.effects(), other.effects());
            let limit = match (names.0.as_slice(), names.1.as_slice()) {
                ([own], [theirs]) => own.1 == theirs.1 && contains(own.0, theirs.0),
                _ => false,
            };
            limit && other.train <= best.train + reach
        });
        Some(simpler.unwrap_or(best).clone())
    }

    /// Whether fitted and held-out residual are both below this many times the noise.
    pub fn below(&self, explanation: &Explanation, times: f64) -> bool {
        let per_row = |chi: f64, rows: usize| chi <= times * times * rows as f64;
        per_row(explanation.train, self.judge.train_rows)
            && per_row(explanation.held_out, self.judge.held_out_rows)
    }

    /// Whether the held-out part, too, is nothing but noise.
    pub fn held_at_floor(&self, explanation: &Explanation) -> bool {
        explanation.held_out <= FLOOR * FLOOR * self.judge.held_out_rows as f64
    }

    /// The explanation without each of its effects, refitted.
    fn ablated(&self, best: &Explanation, baseline: &Explanation) -> Vec<Explanation> {
        let point = &best.fitted.point;
        let terms = point.given_terms..point.terms.len();
        if terms.len() < 2 {
            return vec![baseline.clone(); terms.len()];
        }
        terms
            .map(|term| {
                let fitted = self.problem.fit(&point.without(term), self.projector, LONG);
                self.judge.judge(self.problem, self.projector, fitted)
            })
            .collect()
    }

    /// Drops every effect without which the held-out part is no worse.
    fn prune(&self, explanation: Explanation) -> Explanation {
        let mut best = explanation;
        loop {
            let point = &best.fitted.point;
            let terms = point.given_terms..point.terms.len();
            if terms.len() < 2 {
                return best;
            }
            let unit = self.unit(&best);
            let dropped = terms
                .map(|term| {
                    let fitted = self.problem.fit(&point.without(term), self.projector, LONG);
                    self.judge.judge(self.problem, self.projector, fitted)
                })
                .filter(|without| {
                    let needless = self.criterion(without) < self.criterion(&best) + STRONG * unit;
                    needless || ratio(best.held_out, without.held_out) >= GATE
                })
                .min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)));
            match dropped {
                Some(without) => best = without,
                None => return best,
            }
        }
    }

    /// Explanations with as many effects as the best that are within reach of it.
    fn equals(&self, best: &Explanation, pool: &[Trial], unit: f64) -> Vec<Trial> {
        let mut equals: Vec<Trial> = Vec::new();
        for trial in pool {
            let explanation = &trial.explanation;
            let close = self.criterion(explanation) < self.criterion(best) + EQUAL * unit;
            let held = ratio(explanation.held_out, best.held_out);
            // A law that contains the best one is listed only if it predicts better.
            let limit = match (explanation.effects().as_slice(), best.effects().as_slice()) {
                ([theirs], [own]) => contains(theirs.0, own.0),
                _ => explanation.unknowns() > best.unknowns(),
            };
            let most = if limit { GATE } else { 2.0 - GATE };
            let sound = trial.passed && held < most;
            let same = |other: &Trial| other.explanation.effects() == explanation.effects();
            let new = explanation.effects() != best.effects() && !equals.iter().any(same);
            if close && sound && new && explanation.effects().len() <= best.effects().len() {
                equals.push(trial.clone());
            }
        }
        equals
    }
}

/// Starts of the best candidates, those of one effect and place together.
fn chosen(starts: Vec<Start>, count: usize) -> Vec<Vec<Start>> {
    let mut groups: Vec<Vec<Start>> = Vec::new();
    for start in starts {
        if start.score < HOPELESS {
            break;
        }
        let same = |group: &&mut Vec<Start>| {
            let first: (&str, Place) = (group[0].effect.name, group[0].place);
            first == (start.effect.name, start.place)
        };
        let room = groups.len() < count;
        match groups.iter_mut().find(same) {
            Some(group) => group.push(start),
            None if room => groups.push(vec![start]),
            None => {}
        }
    }
    groups
}

fn passed(trials: &[Trial], count: usize) -> Vec<Explanation> {
    let passed = trials.iter().filter(|trial| trial.passed);
    passed
        .take(count)
        .map(|trial| trial.explanation.clone())
        .collect()
}

fn sort(trials: &mut [Trial]) {
    trials.sort_by(|a, b| {
        let key = |trial: &Trial| trial.explanation.fitted.cost;
        (a.delta_bic, key(a))
            .partial_cmp(&(b.delta_bic, key(b)))
            .unwrap_or(std::cmp::Ordering::Equal)
    });
}

/// `a / b`, 1 where nothing was held out.
pub fn ratio(a: f64, b: f64) -> f64 {
    if b > 0.0 { a / b } else { 1.0 }
}

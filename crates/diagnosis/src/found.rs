//! What a search found.

use super::explanation::Explanation;
use super::point::{EffectAt, Point};

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
    /// Where the explanations of several effects ended that passed.
    pub further: Vec<Point>,
}

impl Found {
    /// The best explanation without one of its effects.
    pub fn without(&self, effect: EffectAt) -> &Explanation {
        let effects = self.best.effects();
        let index = effects.iter().position(|own| *own == effect);
        let ablated = index.and_then(|index| self.ablated.get(index));
        ablated.unwrap_or(&self.baseline)
    }

    /// The explanations that were looked at, one of each structure.
    pub fn points(&self) -> Vec<Point> {
        let trials = self.trials.iter().chain(&self.equals);
        let trials = trials.map(|trial| &trial.explanation);
        let mut each: Vec<&Explanation> = Vec::new();
        for next in std::iter::once(&self.best)
            .chain(trials)
            .chain(&self.ablated)
        {
            if !each.iter().any(|own| own.is_like(next)) {
                each.push(next);
            }
        }
        let points = each.into_iter().map(|own| own.fitted.point.clone());
        points.collect()
    }
}

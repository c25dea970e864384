//! The explanations that were looked at, one of each structure, and what is believed of each.

use super::explanation::{Explanation, Judge};

/// Explanations, each with a structure of its own.
pub struct Pool {
    /// In the order in which they were found; the first is the model as it was given, refitted.
    all: Vec<Explanation>,
}

impl Pool {
    /// With the refitted model alone.
    pub fn new(baseline: Explanation) -> Self {
        Self {
            all: vec![baseline],
        }
    }

    /// Adds an explanation, unless the same structure is there with a better fit.
    pub fn add(&mut self, next: Explanation) {
        match self.all.iter_mut().find(|own| own.is_like(&next)) {
            Some(own) if own.fitted.cost > next.fitted.cost => *own = next,
            Some(_) => {}
            None => self.all.push(next),
        }
    }

    /// The model as it was given, refitted.
    pub fn baseline(&self) -> &Explanation {
        &self.all[0]
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Explanation> {
        self.all.iter()
    }

    /// Chi-squared a row of what is left by the explanation that leaves least, at least 1: of what was fitted and
    /// of what was held out, there beyond the errors of the fit.
    pub fn temperature(&self, judge: &Judge) -> f64 {
        let rows = (judge.train_rows + judge.held_out_rows).max(1) as f64;
        let left = |own: &Explanation| (own.train + own.evidence.held_out_beyond_fit()) / rows;
        self.all.iter().map(left).fold(f64::INFINITY, f64::min).max(1.0)
    }

    /// All of them by the logarithms of their posterior odds, the most probable first.
    pub fn ranked(&self, temperature: f64) -> Vec<(&Explanation, f64)> {
        let scored = |own| (own, Explanation::log_evidence(own, temperature));
        let mut ranked: Vec<(&Explanation, f64)> = self.all.iter().map(scored).collect();
        ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
        ranked
    }
}

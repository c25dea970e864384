//! What the search asks of an explanation: its criterion, and whether more than noise is left.

use super::candidate::Known;
use super::explanation::{Explanation, Judge};
use super::fit::Projector;
use super::found::Trial;
use super::point::Point;
use super::problem::Problem;
use super::thresholds::{FLOOR, LONG, SHAPE};

/// Everything that the search needs.
pub struct Search<'a> {
    /// The problem.
    pub problem: &'a Problem<'a>,
    /// Projects its nuisances out.
    pub projector: &'a Projector,
    /// Judges its fits.
    pub judge: &'a Judge<'a>,
    /// Explanations that were looked at elsewhere.
    pub known: &'a Known,
    /// Told how far the work is, 0 to 1, and what is being done.
    pub progress: &'a (dyn Fn(f64, &str) + Sync),
}

impl Search<'_> {
    /// A structure, fitted from a point on and judged.
    pub fn refitted(&self, point: &Point) -> Explanation {
        let fitted = self.problem.fit(point, self.projector, LONG);
        self.judge.judge(self.problem, fitted)
    }

    /// `chi^2 + k ln N`.
    pub fn criterion(&self, explanation: &Explanation) -> f64 {
        let n = self.judge.train_rows as f64;
        explanation.fitted.cost + explanation.unknowns() as f64 * n.ln()
    }

    /// The explanation of least criterion.
    pub(super) fn lowest<'e>(
        &self,
        all: impl Iterator<Item = &'e Explanation>,
    ) -> Option<&'e Explanation> {
        all.min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b)))
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
        self.at_noise(explanation) || left < SHAPE * mismatch
    }

    /// Whether what was held out, too, is nothing but noise and what the errors of the fit make there, or the
    /// hundredth part of the mismatch.
    pub fn predicts(&self, baseline: &Explanation, explanation: &Explanation) -> bool {
        let rows = self.judge.held_out_rows as f64;
        let (left, mismatch) = (explanation.held_out - rows, baseline.held_out - rows);
        left < SHAPE * mismatch || self.is_held_noise(explanation)
    }

    /// Whether nothing but noise is left, on what was fitted or on all: what holds on moves that were never seen
    /// is not undone by a few instants of the others.
    pub fn at_noise(&self, explanation: &Explanation) -> bool {
        self.at_floor(explanation) || self.all_at_noise(explanation)
    }

    /// Whether nothing but noise is left on fitted and held-out part together.
    pub(super) fn all_at_noise(&self, explanation: &Explanation) -> bool {
        let all = (self.judge.train_rows + self.judge.held_out_rows) as f64;
        explanation.train + explanation.held_out <= FLOOR * all
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

    /// Whether what was held out is no more than noise of a level that is known within a tenth.
    pub fn held_at_noise(&self, explanation: &Explanation) -> bool {
        explanation.held_out <= FLOOR * self.judge.held_out_rows as f64
    }
}

/// Orders trials, the best first.
pub(super) fn sort(trials: &mut [Trial]) {
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

//! An explanation: a fitted structure, and its score on held-out data.

use super::evidence::{CALIBRATED, Evidence};
use super::fit::Fitted;
use super::judge::Judge;
use super::point::{EffectAt, Point};
use super::problem::Problem;
use super::projector::Projector;
use super::thresholds::FLOOR;
use super::views::Views;

/// A fitted structure and its figures.
#[derive(Clone)]
pub struct Explanation {
    /// Where the fit ended.
    pub fitted: Fitted,
    /// Sum of squares of the whitened residual on the fitted rows.
    pub train: f64,
    /// The same on the held-out rows.
    pub held_out: f64,
    /// Its marginal likelihood.
    pub evidence: Evidence,
    /// Term and index of a parameter of its effects that lies at the end of its range.
    pub at_end: Option<(usize, usize)>,
    /// Whether its data say nothing of a parameter that must have one value, were only noise left.
    pub is_meaningless: bool,
}

impl Explanation {
    /// The effects that were added to the model, at their places.
    pub fn effects(&self) -> Vec<EffectAt> {
        self.fitted.point.effects()
    }

    /// Number of terms that were added to the model. An event may have several.
    pub fn terms(&self) -> usize {
        self.fitted.point.terms.len() - self.fitted.point.given_terms
    }

    /// Number of parameters of its effects: a learned law has several resolutions.
    pub fn resolution(&self) -> usize {
        let point = &self.fitted.point;
        let added = point.terms[point.given_terms..].iter();
        added.map(|term| term.values.len()).sum()
    }

    /// Whether one of its laws was learned.
    pub fn is_learned(&self) -> bool {
        let point = &self.fitted.point;
        let mut added = point.terms[point.given_terms..].iter();
        added.any(|term| term.effect.is_learned())
    }

    /// Whether another explanation has the same effects at the same places and as often, in any order.
    pub fn is_like(&self, other: &Self) -> bool {
        self.has_structure_of(&other.fitted.point)
    }

    /// The same, and its learned laws are as fine.
    pub fn is_same(&self, other: &Self) -> bool {
        self.is_like(other) && self.resolution() == other.resolution()
    }

    /// Whether a point has the same effects at the same places and as often, in any order.
    pub fn has_structure_of(&self, other: &Point) -> bool {
        self.fitted.point.structure() == other.structure()
    }

    /// Half the chi-squared of the held-out rows at a temperature.
    pub fn missed(&self, temperature: f64) -> f64 {
        self.held_out / (2.0 * temperature)
    }

    /// Log of its marginal likelihood.
    pub fn log_evidence(&self, temperature: f64) -> f64 {
        self.evidence.log(temperature)
    }
}

impl Judge<'_> {
    /// Chi-squared per row, at least 1: the residual of the best model is the unit of evidence.
    pub fn unit(&self, explanation: &Explanation) -> f64 {
        (explanation.train / self.train_rows.max(1) as f64).max(1.0)
    }

    /// A fit with its figures.
    pub fn judge(&self, problem: &Problem, projector: &Projector, fitted: Fitted) -> Explanation {
        let train = fitted.cost - problem.disbelief(&fitted.point);
        let views = Views::new(self, problem, projector, &fitted.point);
        // If only noise is left, no other shape leaves less.
        let shaped = train > self.train_rows as f64 * FLOOR;
        let evidence = Evidence::new(problem, &views, &fitted, shaped);
        let mut explanation = Explanation {
            train,
            held_out: evidence.held_out(),
            at_end: problem.at_end(&fitted, &evidence),
            is_meaningless: false,
            fitted,
            evidence,
        };
        explanation.is_meaningless = !problem.is_meaningful(&explanation, CALIBRATED);
        explanation
    }
}

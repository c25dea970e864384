//! Whether the parameters of an effect mean anything where the data are.

use super::explanation::Explanation;
use super::point::Global;
use super::problem::Problem;
use quell_model::effects::{ParameterRole, Quantity};

/// Share of the range of a parameter within which it lies at the end of it.
const AT_END: f64 = 1e-3;
/// Two-sided 95 % of the normal distribution.
const NORMAL_95: f64 = 1.96;

impl Problem<'_> {
    /// Whether every effect that was added has parameters that the data have determined, within what was visited.
    ///
    /// The bounds of a parameter are those of the motion: a gap is no wider than the travel, a period no longer, a
    /// frequency within the band. One at the end of its range says that another law is at work; one that could be
    /// anywhere within it says nothing. The ends of a share or of a side are laws of their own, a phase has no
    /// ends, and the shape of a law may be of no consequence.
    pub fn is_meaningful(&self, explanation: &Explanation, temperature: f64) -> bool {
        let point = &explanation.fitted.point;
        let deviations = explanation.evidence.deviations(temperature);
        let globals = explanation.fitted.globals.iter().zip(&deviations);
        globals.into_iter().all(|(&global, &deviation)| {
            let Global::Parameter(term, index) = global else {
                return true;
            };
            if term < point.given_terms {
                return true;
            }
            let parameter = &point.terms[term].effect.parameters[index];
            let value = point.terms[term].values[index];
            let (low, high) = self.limits(point, global);
            let near = |bound: f64| (value - bound).abs() < AT_END * (high - low);
            let whole = |bound: f64| parameter.quantity == Quantity::NUMBER && bound.abs() == 1.0;
            let end = |bound: f64| near(bound) && bound != parameter.neutral && !whole(bound);
            let wide = 2.0 * NORMAL_95 * deviation > high - low;
            match parameter.role {
                ParameterRole::Phase | ParameterRole::Ordinate | ParameterRole::Range => true,
                ParameterRole::Shape => !end(low) && !end(high),
                _ => !end(low) && !end(high) && !wide,
            }
        })
    }
}

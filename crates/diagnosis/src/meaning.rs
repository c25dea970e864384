//! Whether the data determine the parameters of an effect.

use super::evidence::{CALIBRATED, Evidence};
use super::explanation::Explanation;
use super::fit::Fitted;
use super::point::{Global, Point};
use super::prior::is_logarithmic;
use super::problem::Problem;
use quell_model::effects::{Parameter, ParameterRole, Quantity};
use std::cell::LazyCell;

/// Distance from the end of its range within which a parameter counts as at the end, as a share of the range; of
/// its logarithm where the prior is uniform in that.
const AT_END: f64 = 1e-3;
/// A bound this near to 1 stands for 1, the whole of a share.
const WHOLE: f64 = 0.03;
/// Two-sided 95 % of the normal distribution.
const NORMAL_95: f64 = 1.96;

impl Problem<'_> {
    /// Term and index of a parameter of an added effect that lies at the end of its range, which means that another
    /// law is at work.
    ///
    /// The bounds of a parameter are those of the motion: a gap is no wider than the travel, a period no longer, a
    /// frequency within the band. The ends of a share are laws of their own, and a phase has no ends.
    /// An event at the first instant is nothing but another start of the motion. A shape that may be anything
    /// within its range says nothing at its end either.
    pub fn at_end(&self, fitted: &Fitted, evidence: &Evidence) -> Option<(usize, usize)> {
        let point = &fitted.point;
        // Each fit is judged, and few have a shape near an end.
        let deviations = LazyCell::new(|| evidence.deviations(CALIBRATED));
        let is_at_end = |&(unknown, term, index): &(usize, usize, usize)| {
            let parameter = &point.terms[term].effect.parameters[index];
            let value = point.terms[term].values[index];
            let (low, high) = self.limits(point, Global::Parameter(term, index));
            let role = parameter.role;
            let near = |bound: f64| is_near(role, (value, bound), (low, high));
            let may_be_anything = || {
                role == ParameterRole::Shape
                    && spans(role, (value, deviations[unknown]), (low, high))
            };
            // A law at the end of its shape parameter is the simpler law that it contains as a limit.
            let contains = point.terms[term].effect.has_limit_at_end();
            let ends = [low, high].into_iter();
            let mut ends = ends.filter(|&bound| is_meaningless(parameter, bound, contains));
            ends.any(near) && !may_be_anything()
        };
        let first = added(point, &fitted.globals).find(is_at_end);
        first.map(|(_, term, index)| (term, index))
    }

    /// Whether the data determine where and when every added effect acts: no parameter is at the end of its range,
    /// and no confidence interval of a position, an instant, a period or a frequency spans the whole range. The shape
    /// of a law is exempt, since it may not matter, and so is its size: whether there is an effect at all is for the
    /// evidence to say, and one touch shows where an end stop is, not how hard.
    pub fn is_meaningful(&self, explanation: &Explanation, temperature: f64) -> bool {
        let is_one_value = |role: ParameterRole| {
            has_ends(role) && !matches!(role, ParameterRole::Shape | ParameterRole::Size)
        };
        let unknown = || self.unknown(explanation, temperature);
        explanation.at_end.is_none() && !unknown().iter().any(|own| is_one_value(own.1))
    }

    /// A point whose laws are without the parameters that have come to the low end of their range; `None` where none has.
    pub fn without_vanished(&self, point: &Point) -> Option<Point> {
        let has_vanished = |&(term, index): &(usize, usize)| {
            let own = &point.terms[term];
            let (value, role) = (own.values[index], own.effect.parameters[index].role);
            let limits = self.limits(point, Global::Parameter(term, index));
            let may_vanish =
                own.effect.may_be_without(index) && !own.effect.is_without(index, value);
            may_vanish && is_near(role, (value, limits.0), limits)
        };
        let added = point.given_terms..point.terms.len();
        let all = added
            .flat_map(|term| (0..point.terms[term].values.len()).map(move |index| (term, index)));
        let vanished: Vec<(usize, usize)> = all.filter(has_vanished).collect();
        let mut simpler = point.clone();
        for &(term, index) in &vanished {
            let own = &mut simpler.terms[term];
            own.values = own.effect.without(&own.values, index);
        }
        (!vanished.is_empty()).then_some(simpler)
    }

    /// Term and role of the parameters of added effects whose confidence interval spans the whole range.
    pub fn unknown(
        &self,
        explanation: &Explanation,
        temperature: f64,
    ) -> Vec<(usize, ParameterRole)> {
        let fitted = &explanation.fitted;
        let deviations = explanation.evidence.deviations(temperature);
        let wide = |(unknown, term, index): (usize, usize, usize)| {
            let own = &fitted.point.terms[term];
            let role = own.effect.parameters[index].role;
            let limits = self.limits(&fitted.point, Global::Parameter(term, index));
            let known = (own.values[index], deviations[unknown]);
            spans(role, known, limits).then_some((term, role))
        };
        added(&fitted.point, &fitted.globals)
            .filter_map(wide)
            .collect()
    }
}

/// Whether a value is near a bound of its range.
fn is_near(role: ParameterRole, (value, bound): (f64, f64), (low, high): (f64, f64)) -> bool {
    match is_logarithmic(role, (low, high)) {
        true => (value / bound).ln().abs() < AT_END * (high / low).ln(),
        false => (value - bound).abs() < AT_END * (high - low),
    }
}

/// Whether the 95 % interval of a parameter of this value and standard deviation is as wide as its range.
fn spans(role: ParameterRole, (value, deviation): (f64, f64), (low, high): (f64, f64)) -> bool {
    let interval = 2.0 * NORMAL_95 * deviation;
    match is_logarithmic(role, (low, high)) {
        true => interval > value * (high / low).ln(),
        false => interval > high - low,
    }
}

/// Whether a parameter at this end of its range is a value without meaning. `contains` tells whether its effect
/// contains a simpler law as a limit of its shape.
fn is_meaningless(parameter: &Parameter, bound: f64, contains: bool) -> bool {
    let whole = parameter.quantity == Quantity::NUMBER && (bound.abs() - 1.0).abs() < WHOLE;
    match parameter.role {
        // No instant is neutral: the first one is the start, after the last one nothing is seen.
        ParameterRole::Time => true,
        ParameterRole::Shape if contains => true,
        role => has_ends(role) && bound != parameter.neutral && !whole,
    }
}

/// Whether the ends of a parameter's range are meaningless values.
fn has_ends(role: ParameterRole) -> bool {
    !matches!(role, ParameterRole::Phase | ParameterRole::Ordinate) && role.is_fitted()
}

/// The unknowns that are parameters of added effects: index of the unknown, term and parameter.
fn added<'a>(
    point: &'a Point,
    globals: &'a [Global],
) -> impl Iterator<Item = (usize, usize, usize)> + use<'a> {
    let all = globals.iter().enumerate();
    all.filter_map(|(unknown, global)| match *global {
        Global::Parameter(term, index) if term >= point.given_terms => Some((unknown, term, index)),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use quell_model::effects::{EFFECTS, Scales};

    /// An order half above the least one is no end, though a range of three decades has thousandths larger than that.
    #[test]
    fn the_ends_of_a_range_of_decades_are_ratios() {
        let order = |value| is_near(ParameterRole::Order, (value, 11.0), (11.0, 7000.0));
        assert!(order(11.0) && order(11.05) && !order(16.5));
        let width = |deviation| spans(ParameterRole::Order, (100.0, deviation), (11.0, 7000.0));
        assert!(width(200.0) && !width(100.0));
        let position = |value| is_near(ParameterRole::Position, (value, 1.0), (1.0, 9.0));
        assert!(position(1.007) && !position(1.009));
    }

    /// Over the catalogue: an event at either end of its time says nothing; a size at its neutral value is no
    /// end, since the effect is then not there.
    #[test]
    fn an_instant_has_ends_and_a_neutral_size_has_none() {
        let scales = Scales {
            span: (0.0, 8.0),
            ..Scales::default()
        };
        let (mut times, mut sizes) = (0, 0);
        for effect in EFFECTS {
            for parameter in effect.parameters {
                let (low, high) = (parameter.bounds)(&scales);
                let ends = [low, high].map(|bound| is_meaningless(parameter, bound, false));
                let what = format!("{} {}", effect.name, parameter.name);
                match parameter.role {
                    ParameterRole::Time => {
                        times += 1;
                        assert_eq!(ends, [true, true], "{what}");
                    }
                    ParameterRole::Size if low == parameter.neutral => {
                        sizes += 1;
                        assert!(!ends[0], "{what}");
                    }
                    ParameterRole::Phase
                    | ParameterRole::Ordinate
                    | ParameterRole::Range
                    | ParameterRole::Side => {
                        assert_eq!(ends, [false, false], "{what}");
                    }
                    _ => {}
                }
            }
        }
        assert!(times >= 2 && sizes >= 5, "{times} {sizes}");
    }
}

//! The static law of a finding over the visited range, with its 95 % band.

use super::bootstrap::Scatter;
use super::law_curve::{LawCurve, LawParameter, LearnedLaw, NearestLaw};
use super::law_points::law_points;
use super::point::{EffectAt, Global, Point};
use super::problem::Problem;
use super::units::units;
use nalgebra::{DMatrix, DVector};
use quell_model::Term;
use quell_model::curves::{BAND, Curve, NamedLaws, points};
use quell_model::effects::{LEARNED, Motion, Place, Scales, Slot, Units, curve};

/// The law of an effect of a point as a curve; `None` if it is no static law, or occurs several times.
pub fn law_curve(
    problem: &Problem,
    point: &Point,
    effect: EffectAt,
    scatter: &Scatter,
) -> Option<LawCurve> {
    let slot = effect.0.slot()?;
    let added = point.given_terms..point.terms.len();
    let mut own = added.filter(|term| point.terms[*term].identity() == effect);
    let (index, None) = (own.next()?, own.next()) else {
        return None;
    };
    let drawn = Drawn {
        problem,
        point,
        slot,
        term: &point.terms[index],
        at: still(problem, point),
        units: units(problem, point),
    };
    let globals: Vec<Global> = (0..drawn.term.values.len())
        .map(|parameter| Global::Parameter(index, parameter))
        .collect();
    let covariance = scatter.covariance(&globals);
    let told = match drawn.term.effect.is_learned() {
        true => drawn.learned(&covariance),
        false => drawn.named(&covariance),
    };
    told.filter(LawCurve::is_finite)
}

/// The variables of a law beside its coordinate, with the stiffness and damping of a point.
pub fn still(problem: &Problem, point: &Point) -> Motion {
    (problem.kind.linear)(&point.keys, problem.experiments[0].input).at_rest()
}

/// A law to be drawn.
struct Drawn<'a> {
    problem: &'a Problem<'a>,
    point: &'a Point,
    slot: Slot,
    term: &'a Term,
    at: Motion,
    units: Units,
}

impl Drawn<'_> {
    /// A learned law with its description in words and the nearest named law.
    fn learned(&self, covariance: &DMatrix<f64>) -> Option<LawCurve> {
        let Term { effect, values, .. } = self.term;
        let ordinates = super::curves::ordinates(effect);
        let of_ordinates = covariance
            .select_rows(&ordinates)
            .select_columns(&ordinates);
        let curve = Curve::new(effect, values, &of_ordinates, &self.at)?;
        let learned = LearnedLaw {
            sentence: curve.shape().sentence(&curve, &self.units),
            nearest: self.nearest(&curve),
        };
        Some(LawCurve {
            learned: Some(learned),
            ..self.told(&curve.points, curve.values.as_slice(), &curve.band())
        })
    }

    fn nearest(&self, curve: &Curve) -> Option<NearestLaw> {
        let Problem {
            scales, catalogue, ..
        } = self.problem;
        let laws = NamedLaws::of(curve, self.term.place, &self.at, scales, *catalogue)?;
        let nearest = laws.nearest().into_iter().next()?;
        let parameters = nearest.effect.parameters.iter().zip(&nearest.values);
        let told = NearestLaw {
            effect: nearest.effect.name.into(),
            parameters: parameters
                .map(|(parameter, value)| LawParameter {
                    name: parameter.name.into(),
                    value: *value,
                    unit: parameter.quantity.unit(&self.units),
                })
                .collect(),
            values: nearest.at_points,
            chi_squared: nearest.chi_squared,
            outside: nearest.outside.iter().map(|&(a, b)| [a, b]).collect(),
        };
        let finite = told.values.iter().all(|value| value.is_finite());
        (finite && told.chi_squared.is_finite()).then_some(told)
    }

    /// A named law over the visited range.
    fn named(&self, covariance: &DMatrix<f64>) -> Option<LawCurve> {
        let Term { effect, values, .. } = self.term;
        let range = visited(self.slot, self.term.place, &self.problem.scales)?;
        let points = points(self.slot, range);
        let at = |values: &[f64]| {
            let law = curve(effect, values, &self.at, &points);
            law.map(DVector::from_vec)
        };
        let law = at(values)?;
        let deviation = |k: usize| covariance[(k, k)].sqrt();
        // Changes of the law by one standard deviation of each parameter: a law need not be linear in them.
        let mut changes = DMatrix::zeros(points.len(), values.len());
        for (k, parameter) in effect.parameters.iter().enumerate() {
            let (low, high) = (parameter.bounds)(&self.problem.scales);
            let moved = |sign: f64| {
                let mut moved = values.clone();
                moved[k] += sign * deviation(k);
                moved[k] = moved[k].max(low.min(values[k])).min(high.max(values[k]));
                (moved[k], at(&moved))
            };
            let [(above, with), (below, without)] = [1.0, -1.0].map(moved);
            if above > below {
                changes.set_column(k, &((with? - without?) / (above - below)));
            }
        }
        let variances = (&changes * covariance * changes.transpose()).diagonal();
        let band: Vec<f64> = variances.iter().map(|v| BAND * v.max(0.0).sqrt()).collect();
        Some(self.told(&points, law.as_slice(), &band))
    }

    fn told(&self, points: &[f64], values: &[f64], band: &[f64]) -> LawCurve {
        let [coordinate, law] = self.slot.quantities();
        let pairs = values.iter().zip(band);
        LawCurve {
            law: self.slot.law().into(),
            unit: law.unit(&self.units),
            coordinate: self.slot.coordinate().name().into(),
            coordinate_unit: coordinate.unit(&self.units),
            points: points.to_vec(),
            values: values.to_vec(),
            ci95: pairs
                .map(|(value, half)| [value - half, value + half])
                .collect(),
            seen: law_points(self.problem, self.point, self.term.identity()),
            learned: None,
        }
    }
}

/// Visited range of the coordinate of a slot: that of its learned law.
fn visited(slot: Slot, place: Place, scales: &Scales) -> Option<(f64, f64)> {
    let learned = LEARNED.iter().find(|effect| effect.slot() == Some(slot))?;
    let start = learned.starts_at(place, scales).swap_remove(0);
    match start[..] {
        [.., from, to] => Some((from, to)),
        _ => None,
    }
    .filter(|(from, to)| from < to)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_visited_is_told_for_every_slot_and_place() {
        let scales = Scales {
            deformation: 1e-3,
            deformation_rate: 0.1,
            position: (-1.0, 2.0),
            velocity: 1.5,
            acceleration: 9.0,
            force: 3.0,
            input: 3.0,
            natural_frequency: 40.0,
            damping_ratio: 0.02,
            span: (0.0, 8.0),
            sample_time: 1e-3,
            candidate_events: Vec::new(),
            candidate_frequencies: Vec::new(),
            candidate_orders: Vec::new(),
            candidate_stops: Vec::new(),
            forced: true,
            tracked: false,
            rigid: false,
            visited: quell_model::effects::Visited::default(),
        };
        for effect in LEARNED {
            let slot = effect.slot().unwrap();
            for place in effect.places {
                let range = visited(slot, *place, &scales).unwrap();
                let points = points(slot, range);
                assert!(points.is_sorted() && points[0] < points[1], "{effect:?}");
                assert_eq!(*points.last().unwrap(), range.1, "{effect:?}");
            }
        }
    }
}

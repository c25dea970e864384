//! The named laws that are nearest to a learned curve.

use super::Curve;
use crate::effects::{Catalogue, Effect, Motion, Parameter, ParameterRole, Place, Scales, curve};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use quell_signal::SingularValues;
use std::f64::consts::TAU;

/// A named law, fitted to a learned curve.
#[derive(Clone, Debug)]
pub struct Nearest {
    /// The named law.
    pub effect: &'static Effect,
    /// Values of its parameters.
    pub values: Vec<f64>,
    /// Squared distance from the learned ordinates in their standard deviations, for each degree of freedom:
    /// about 1 if the law equals the curve.
    pub chi_squared: f64,
    /// The law at the points of the curve.
    pub at_points: Vec<f64>,
    /// Ranges of the coordinate where it is outside of the 95 % band of the curve.
    pub outside: Vec<(f64, f64)>,
}

/// Two named laws whose sum was fitted to a learned curve, each with the values of its parameters.
pub type Sum = [(&'static Effect, Vec<f64>); 2];

/// Number of starts that are fitted to convergence, those of least residual.
const FOLLOWED: usize = 4;

/// Most steps of a descent: with at most four unknowns it ends far sooner.
const STEPS: usize = 60;

/// Step of a parameter for its derivative, as a share of its typical size.
const CHANGE: f64 = 1e-5;

/// Singular values, relative to the greatest, of ordinates that the curve does not depend on.
const DEPENDENT: f64 = 1e-10;

/// Least standard deviation of an ordinate, as a share of the largest ordinate.
const ROUNDING: f64 = 1e-9;

/// The named laws of a catalogue that can stand for a learned curve at a place, to be fitted to its ordinates with their
/// covariance.
pub struct NamedLaws<'a> {
    learned: &'a Curve,
    scales: &'a Scales,
    place: Place,
    catalogue: Catalogue,
    target: Target<'a>,
}

impl<'a> NamedLaws<'a> {
    /// For a curve; `at` is the motion for [`curve`]. `None` where its ordinates have no covariance.
    pub fn of(
        learned: &'a Curve,
        place: Place,
        at: &'a Motion,
        scales: &'a Scales,
        catalogue: Catalogue,
    ) -> Option<Self> {
        Some(Self {
            learned,
            scales,
            place,
            catalogue,
            target: Target::new(learned, at)?,
        })
    }

    /// The laws in the slot of the curve; the nearest first.
    pub fn nearest(&self) -> Vec<Nearest> {
        let fit = |effect| self.target.nearest(effect, self.learned, self.scales);
        let mut found: Vec<Nearest> = self.in_slot().filter_map(fit).collect();
        found.sort_by(|a, b| a.chi_squared.total_cmp(&b.chi_squared));
        found
    }

    /// The sums of two laws: of those in the slot, and of those as which one of them acts; the nearest first.
    pub fn nearest_sums(&self) -> Vec<Sum> {
        let mut laws: Vec<&'static Effect> = self.in_slot().collect();
        for whole in laws.clone() {
            let parts = whole.parts(&whole.neutral()).into_iter().flatten();
            let parts = parts.map(|part| part.0);
            let known = |part: &&Effect| self.catalogue.0.contains(part) && !laws.contains(part);
            let parts = parts.filter(|part| part.places.contains(&self.place) && known(part));
            let parts: Vec<_> = parts.collect();
            laws.extend(parts);
        }
        let laws = &laws;
        let pairs = (0..laws.len()).flat_map(|k| laws[..k].iter().map(move |one| [*one, laws[k]]));
        let mut found: Vec<(f64, Sum)> = pairs
            .filter_map(|[one, other]| {
                let (chi_squared, mut values) = self.target.fit(&[one, other], self.scales)?;
                let others = values.split_off(one.parameters.len());
                Some((chi_squared, [(one, values), (other, others)]))
            })
            .collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|own| own.1).collect()
    }

    /// The laws in the slot of the curve.
    fn in_slot(&self) -> impl Iterator<Item = &'static Effect> {
        let slot = Some(self.learned.slot);
        let all = self.catalogue.0.iter().copied();
        let named = all.filter(move |effect| !effect.is_learned() && effect.slot() == slot);
        named.filter(|effect| effect.places.contains(&self.place))
    }
}

/// The target of a fit: the ordinates of the learned curve. Those of a named law are of least squares over the range, so that a wave
/// that is shorter than the distance of the knots is none of the longer waves that have the same values there.
struct Target<'a> {
    at: &'a Motion,
    /// Coordinates.
    points: &'a [f64],
    ordinates: DVector<f64>,
    /// Maps values of a law at the coordinates to its ordinates.
    onto: DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl<'a> Target<'a> {
    fn new(learned: &'a Curve, at: &'a Motion) -> Option<Self> {
        let count = learned.of_ordinates.nrows();
        let ordinates = DVector::from_column_slice(&learned.parameters[..count]);
        let mut covariance = learned.of_ordinates.clone();
        let least = (ROUNDING * ordinates.amax())
            .max(f64::MIN_POSITIVE.sqrt())
            .powi(2);
        for k in 0..count {
            covariance[(k, k)] += least;
        }
        Some(Self {
            at,
            points: &learned.points,
            ordinates,
            onto: SingularValues::of(&learned.parts)?.pseudo_inverse(DEPENDENT),
            factor: covariance.cholesky()?,
        })
    }

    /// The ordinates of a law; `None` where it has no finite value.
    fn ordinates(&self, law: &Effect, values: &[f64]) -> Option<DVector<f64>> {
        let own = &self.onto * DVector::from_vec(curve(law, values, self.at, self.points)?);
        own.iter().all(|value| value.is_finite()).then_some(own)
    }

    /// The residual of a law with these ordinates in standard deviations.
    fn white(&self, ordinates: &DVector<f64>) -> Option<DVector<f64>> {
        let left = ordinates - &self.ordinates;
        self.factor.l().solve_lower_triangular(&left)
    }

    /// The residual of a sum of laws in standard deviations; `None` where one has no finite value.
    fn residual(&self, laws: &[&Effect], mut values: &[f64]) -> Option<DVector<f64>> {
        let mut sum = DVector::zeros(self.ordinates.len());
        for law in laws {
            let (own, others) = values.split_at(law.parameters.len());
            sum += self.ordinates(law, own)?;
            values = others;
        }
        self.white(&sum)
    }

    /// The starts of a sum of laws with the squared residual of each, the best first.
    fn starts(&self, laws: &[&Effect], scales: &Scales) -> Vec<(f64, Vec<f64>)> {
        let mut starts = vec![(Vec::new(), DVector::zeros(self.ordinates.len()))];
        for law in laws {
            let own = (law.starts)(scales).into_iter();
            let own = own.filter_map(|values| Some((self.ordinates(law, &values)?, values)));
            let own: Vec<_> = own.collect();
            let with = |(before, sum): &(Vec<f64>, DVector<f64>)| -> Vec<_> {
                let both = own
                    .iter()
                    .map(|(part, values)| ([before.as_slice(), values].concat(), sum + part));
                both.collect()
            };
            starts = starts.iter().flat_map(with).collect();
        }
        let sized = |(values, sum)| Some((self.white(&sum)?.norm_squared(), values));
        let mut sized: Vec<(f64, Vec<f64>)> = starts.into_iter().filter_map(sized).collect();
        sized.sort_by(|a, b| a.0.total_cmp(&b.0));
        sized
    }

    /// The values of a sum of laws of least squared distance from the curve, and that for each degree of freedom.
    fn fit(&self, laws: &[&Effect], scales: &Scales) -> Option<(f64, Vec<f64>)> {
        let starts = self.starts(laws, scales).into_iter().take(FOLLOWED);
        let ends = starts.map(|(_, values)| self.descend(laws, values, scales));
        let (cost, values) = ends.flatten().min_by(|a, b| a.0.total_cmp(&b.0))?;
        let freedom = self.ordinates.len().saturating_sub(values.len()).max(1);
        Some((cost / freedom as f64, wrapped(laws, values)))
    }

    fn nearest(
        &self,
        effect: &'static Effect,
        learned: &Curve,
        scales: &Scales,
    ) -> Option<Nearest> {
        let (chi_squared, values) = self.fit(&[effect], scales)?;
        let at_points = curve(effect, &values, self.at, self.points)?;
        Some(Nearest {
            effect,
            chi_squared,
            outside: self.outside(learned, effect, &values)?,
            values,
            at_points,
        })
    }

    /// Levenberg and Marquardt within the bounds of the parameters.
    fn descend(
        &self,
        laws: &[&Effect],
        mut values: Vec<f64>,
        scales: &Scales,
    ) -> Option<(f64, Vec<f64>)> {
        let parameters: Vec<&Parameter> = laws.iter().flat_map(|law| law.parameters).collect();
        let mut left = self.residual(laws, &values)?;
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            let jacobian = self.jacobian((laws, &parameters), &values, &left, scales)?;
            let mut normal = jacobian.transpose() * &jacobian;
            let right = jacobian.transpose() * &left;
            let largest = normal.diagonal().amax();
            for k in 0..values.len() {
                normal[(k, k)] += damping * normal[(k, k)] + f64::EPSILON * largest;
            }
            let step = normal.cholesky()?.solve(&right);
            let moved = |(k, value): (usize, &f64)| {
                let parameter = parameters[k];
                let (low, high) = (parameter.bounds)(scales);
                (value - step[k] * (parameter.typical)(scales)).clamp(low, high)
            };
            let next: Vec<f64> = values.iter().enumerate().map(moved).collect();
            let then = self.residual(laws, &next);
            match then.filter(|then| then.norm_squared() < left.norm_squared()) {
                Some(then) => {
                    let gain = left.norm_squared() - then.norm_squared();
                    let done = gain <= 1e-10 * left.norm_squared();
                    (values, left) = (next, then);
                    damping = (0.2 * damping).max(1e-12);
                    if done {
                        break;
                    }
                }
                None if damping > 1e8 => break,
                None => damping *= 8.0,
            }
        }
        Some((left.norm_squared(), values))
    }

    /// Derivatives of the residual by each parameter, in its typical size.
    fn jacobian(
        &self,
        (laws, parameters): (&[&Effect], &[&Parameter]),
        values: &[f64],
        left: &DVector<f64>,
        scales: &Scales,
    ) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(left.len(), values.len());
        for (k, parameter) in parameters.iter().enumerate() {
            let (typical, (_, high)) = ((parameter.typical)(scales), (parameter.bounds)(scales));
            // Inside the bounds.
            let sign = if values[k] + CHANGE * typical.abs() > high {
                -1.0
            } else {
                1.0
            };
            let change = sign * CHANGE * typical.abs() / typical;
            let mut changed = values.to_vec();
            changed[k] += change * typical;
            let column = (self.residual(laws, &changed)? - left) / change;
            jacobian.set_column(k, &column);
        }
        Some(jacobian)
    }

    /// Ranges of the coordinate where a law is outside of the band of the curve. Details of it that no ordinates represent do not
    /// count.
    fn outside(&self, learned: &Curve, effect: &Effect, values: &[f64]) -> Option<Vec<(f64, f64)>> {
        let off = &learned.parts * (self.ordinates(effect, values)? - &self.ordinates);
        let (band, least) = (learned.band(), ROUNDING * learned.values.amax());
        let (mut ranges, mut inside): (Vec<(f64, f64)>, bool) = (Vec::new(), true);
        for (k, &x) in learned.points.iter().enumerate() {
            let out = off[k].abs() > band[k] + least;
            match ranges.last_mut() {
                Some(range) if out && !inside => range.1 = x,
                _ if out => ranges.push((x, x)),
                _ => {}
            }
            inside = !out;
        }
        Some(ranges)
    }
}

/// Phases are reported within half a turn of 0.
fn wrapped(laws: &[&Effect], mut values: Vec<f64>) -> Vec<f64> {
    let parameters = laws.iter().flat_map(|law| law.parameters);
    for (parameter, value) in parameters.zip(&mut values) {
        if parameter.role == ParameterRole::Phase {
            *value -= TAU * (*value / TAU).round();
        }
    }
    values
}

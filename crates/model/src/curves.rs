//! Learned curves: their description in words, and the nearest named law.

mod energy;
mod estimate;
mod nearest;
mod sentence;
mod shape;

pub use estimate::Estimate;
pub use nearest::{NamedLaws, Nearest, Sum};
pub use shape::{Growth, Shape, Trend};

use crate::effects::{
    Effect, Motion, ParameterRole, Slot, curve, even_velocities, slip_distances, slip_velocities,
};
use nalgebra::{DMatrix, DVector};

/// 97.5 % quantile of the normal distribution: the half width of a 95 % band in standard deviations.
pub const BAND: f64 = 1.959_963_985;

/// A learned law as a curve, with its uncertainty.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The effect that was learned.
    pub effect: &'static Effect,
    /// The slot of its law.
    pub slot: Slot,
    /// Values of its parameters.
    pub parameters: Vec<f64>,
    /// Covariance of its ordinates.
    pub of_ordinates: DMatrix<f64>,
    /// Points of the coordinate, in rising order.
    pub points: Vec<f64>,
    /// The law at the points.
    pub values: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Derivative of the values by each ordinate.
    parts: DMatrix<f64>,
}

/// Number of points of a curve: several for each knot.
const POINTS: usize = 120;

/// Step of an ordinate, of size 1, for its derivative.
const CHANGE: f64 = 0.25;

impl Curve {
    /// A learned effect with values of its parameters and the covariance of its ordinates. None where the effect
    /// is not learned, values or covariance are not of its size, or its range is empty.
    pub fn new(
        effect: &'static Effect,
        parameters: &[f64],
        of_ordinates: &DMatrix<f64>,
        at: &Motion,
    ) -> Option<Self> {
        let slot = effect.slot().filter(|_| effect.is_learned())?;
        let ordinates = ordinates(effect);
        let known = of_ordinates.shape() == (ordinates, ordinates);
        let [.., from, to] = *parameters else {
            return None;
        };
        if !known || parameters.len() != effect.parameters.len() || !from.lt(&to) {
            return None;
        }
        let points = match slot {
            Slot::Friction => slip_velocities(parameters, POINTS / 2),
            _ => points(slot, (from, to)),
        };
        let values = DVector::from_vec(curve(effect, parameters, at, &points)?);
        let parts = parts(effect, parameters, at, &points)?;
        let covariance = &parts * of_ordinates * parts.transpose();
        Some(Self {
            effect,
            slot,
            parameters: parameters.to_vec(),
            of_ordinates: of_ordinates.clone(),
            points,
            values,
            covariance,
            parts,
        })
    }

    /// Half width of the 95 % band at each point.
    pub fn band(&self) -> Vec<f64> {
        let variances = self.covariance.diagonal();
        let half = |variance: &f64| BAND * variance.max(0.0).sqrt();
        variances.iter().map(half).collect()
    }

    /// Coordinate of each ordinate.
    pub fn knots(&self) -> Vec<f64> {
        knots(self.effect, &self.parameters)
    }

    /// A linear function of the curve, `sum w_i f(x_i)`.
    fn estimate(&self, weights: &DVector<f64>) -> Estimate {
        let variance = weights.dot(&(&self.covariance * weights));
        Estimate {
            value: weights.dot(&self.values),
            std: variance.max(0.0).sqrt(),
        }
    }

    /// The first point that is not below a coordinate.
    fn index(&self, x: f64) -> usize {
        let index = self.points.partition_point(|point| *point < x);
        index.min(self.points.len() - 1)
    }
}

/// Coordinate of each ordinate of a learned effect with these values; empty for another one.
pub fn knots(effect: &Effect, parameters: &[f64]) -> Vec<f64> {
    match (effect.slot(), parameters) {
        _ if !effect.is_learned() => Vec::new(),
        (Some(Slot::Hysteresis), _) => slip_distances(parameters).to_vec(),
        (Some(Slot::Friction), _) => slip_velocities(parameters, ordinates(effect) / 2),
        (Some(slot), [.., from, to]) => over(slot, (*from, *to), ordinates(effect)),
        _ => Vec::new(),
    }
}

/// How many ordinates a learned effect has.
pub(crate) fn ordinates(effect: &Effect) -> usize {
    let own = effect.parameters.iter();
    own.filter(|p| p.role == ParameterRole::Ordinate).count()
}

/// Points over a range at which a law is evaluated.
pub fn points(slot: Slot, range: (f64, f64)) -> Vec<f64> {
    over(slot, range, POINTS)
}

/// Points over the range of a law, evenly spaced. A law over the velocity has half of them in each direction, the
/// innermost at rest; a hysteresis begins at rest.
fn over(slot: Slot, (from, to): (f64, f64), count: usize) -> Vec<f64> {
    let even = |from: f64| {
        let step = (to - from) / (count - 1) as f64;
        (0..count).map(|k| from + step * k as f64).collect()
    };
    match slot {
        Slot::Friction => even_velocities((from, to), count / 2),
        Slot::Hysteresis => even(0.0),
        _ => even(from),
    }
}

/// Change of the curve with each ordinate: points in rows, ordinates in columns. A law is linear in its ordinates
/// but for limits that physics sets it, such as a level of friction above 0; here they are far.
fn parts(effect: &Effect, parameters: &[f64], at: &Motion, points: &[f64]) -> Option<DMatrix<f64>> {
    let ordinates = ordinates(effect);
    let mut inside = parameters.to_vec();
    inside[..ordinates].fill(1.0);
    let before = curve(effect, &inside, at, points)?;
    let mut parts = DMatrix::zeros(points.len(), ordinates);
    for ordinate in 0..ordinates {
        let mut changed = inside.clone();
        changed[ordinate] += CHANGE;
        let after = curve(effect, &changed, at, points)?;
        for (row, (after, before)) in after.iter().zip(&before).enumerate() {
            parts[(row, ordinate)] = (after - before) / CHANGE;
        }
    }
    Some(parts)
}

//! Prior of the curve of a learned law: it is smooth, and its size is unknown.
//!
//! Its ordinates `y` have a multivariate Student density about 0,
//!
//! ```text
//! p(y) ~ (1 + q / nu)^(-(nu + n) / 2) ,   q = |L^-1 y|^2 / s^2
//! ```
//!
//! `L L'` is the covariance of a smooth curve of standard deviation 1 at `n` knots, `s` the typical size of an
//! ordinate, and `nu = 1` the degrees of freedom. It is a Gaussian process whose size has a scale-free prior.
//!
//! Source: Rasmussen and Williams, Gaussian Processes for Machine Learning (2006), chapters 4 and 9.9.

use super::point::Global;
use nalgebra::{Cholesky, DMatrix, DVector};
use quell_model::Term;
use quell_model::effects::{Effect, ParameterRole, Scales, Slot};

/// Degrees of freedom.
const NU: f64 = 1.0;
/// Correlation length of a curve, in knots. Shorter changes are ripples, which are laws of their own.
const SMOOTH: f64 = 2.5;
/// Correlation of the two directions of a law of friction.
const MIRRORED: f64 = 0.9;
/// Added to the diagonal, so that the covariance of near knots stays positive definite.
const NUGGET: f64 = 1e-6;

/// Indices of the ordinates of a learned law.
pub fn ordinates(effect: &Effect) -> Vec<usize> {
    let all = effect.parameters.iter().enumerate();
    let own = all.filter(|(_, parameter)| parameter.role == ParameterRole::Ordinate);
    own.map(|(index, _)| index).collect()
}

/// Root `L` of the covariance of the ordinates of a learned law, for a standard deviation of 1. Friction has
/// one curve in each direction, and the two are strongly correlated.
pub fn root(effect: &Effect) -> DMatrix<f64> {
    let count = ordinates(effect).len();
    let near = |distance: f64| (-0.5 * (distance / SMOOTH).powi(2)).exp();
    let covariance = match effect.slot() {
        Some(Slot::Friction) => DMatrix::from_fn(count, count, |i, j| {
            let speed = |k: usize| (k as f64 + 0.5 - count as f64 / 2.0).abs();
            let same = (i < count / 2) == (j < count / 2);
            near(speed(i) - speed(j)) * if same { 1.0 } else { MIRRORED }
        }),
        Some(Slot::Hysteresis) => DMatrix::identity(count, count),
        _ => DMatrix::from_fn(count, count, |i, j| near(i as f64 - j as f64)),
    };
    let covariance = covariance + DMatrix::identity(count, count) * NUGGET;
    Cholesky::new(covariance).map_or_else(|| DMatrix::identity(count, count), |root| root.l())
}

/// Typical size of an ordinate.
pub fn size(scales: &Scales, effect: &Effect) -> f64 {
    let first = effect.parameters.iter();
    let mut first = first.filter(|parameter| parameter.role == ParameterRole::Ordinate);
    first
        .next()
        .map_or(1.0, |parameter| (parameter.typical)(scales).abs())
}

/// Ordinates in units of their deviations, and `q`.
fn whitened(scales: &Scales, term: &Term) -> Option<(DMatrix<f64>, DVector<f64>, f64)> {
    let indices = ordinates(term.effect);
    let count = indices.len();
    let inverse = root(term.effect).solve_lower_triangular(&DMatrix::identity(count, count))?;
    let inverse = inverse / size(scales, term.effect);
    let values = DVector::from_iterator(count, indices.iter().map(|&k| term.values[k]));
    let white = &inverse * values;
    let square = white.norm_squared();
    (count > 0).then_some((inverse, white, square))
}

/// Twice the negative logarithm of the density, without its constant.
pub fn cost(scales: &Scales, term: &Term) -> f64 {
    if !term.effect.is_learned() {
        return 0.0;
    }
    let count = ordinates(term.effect).len() as f64;
    whitened(scales, term).map_or(0.0, |(_, _, q)| (NU + count) * (q / NU).ln_1p())
}

/// A departure from what is believed, in standard deviations, and its derivatives by unknowns.
pub type Row = (f64, Vec<(Global, f64)>);

/// Rows of a least-squares fit that have the derivatives of the density: those of the Gaussian density with the
/// same slope at the curve.
pub fn beliefs(scales: &Scales, index: usize, term: &Term) -> Vec<Row> {
    if !term.effect.is_learned() {
        return Vec::new();
    }
    let Some((inverse, white, q)) = whitened(scales, term) else {
        return Vec::new();
    };
    let indices = ordinates(term.effect);
    let weight = tightness(q, indices.len()).sqrt();
    let row = |i: usize| {
        let slope = |(j, &parameter): (usize, &usize)| {
            (
                Global::Parameter(index, parameter),
                weight * inverse[(i, j)],
            )
        };
        let slopes = indices.iter().enumerate().map(slope).collect();
        (weight * white[i], slopes)
    };
    (0..indices.len()).map(row).collect()
}

/// Precision of the Gaussian density that has the same slope at `q`.
fn tightness(q: f64, count: usize) -> f64 {
    (NU + count as f64) / (NU + q)
}

/// Root of the covariance of the Gaussian density with the same slope at the fitted curve, and the logarithm of
/// the ratio of the true density to this one, at the fit.
pub fn effective(scales: &Scales, term: &Term) -> (DMatrix<f64>, f64) {
    let count = ordinates(term.effect).len();
    let q = whitened(scales, term).map_or(0.0, |own| own.2);
    let tight = tightness(q, count);
    let n = count as f64;
    // ln [Gamma((nu + n) / 2) / Gamma(nu / 2) (nu / 2)^(-n / 2)] - n / 2 ln(tight), Gamma(1 / 2) = sqrt(pi).
    let log_gamma = |half: usize| -> f64 {
        let steps = (1..half).step_by(2).map(|k| (k as f64 / 2.0).ln());
        let start = if half % 2 == 1 {
            0.5 * std::f64::consts::PI.ln()
        } else {
            0.0
        };
        start
            + match half % 2 {
                1 => steps.sum::<f64>(),
                _ => (1..half / 2).map(|k| (k as f64).ln()).sum::<f64>(),
            }
    };
    let whole = log_gamma(count + 1) - log_gamma(1) - 0.5 * n * (NU / 2.0).ln();
    let root = root(term.effect) * (size(scales, term.effect) / tight.sqrt());
    (root, whole - 0.5 * n * tight.ln())
}

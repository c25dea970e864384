//! Screening of learned laws: the likeliest curve in first order, and its evidence.

use super::{Factor, Screen, Start};
use crate::autocorrelation::correlation;
use crate::curves::{ordinates, root, size};
use nalgebra::{Cholesky, DMatrix, DVector};
use quell_model::Term;
use quell_model::effects::{Effect, Place};

/// Step of the derivative by an ordinate of a learned law, in typical sizes.
const FINE: f64 = 1e-2;
/// Greatest standard deviation of a learned law's curve in first order, in typical sizes.
const CURVE: f64 = 3.0;

/// A learned law about its neutral values, in first order.
pub(super) struct Curve {
    /// The law with the curve from which a fit starts.
    term: Term,
    /// Products of the changes of the rows by the white unknowns with themselves and with the residual.
    products: (DMatrix<f64>, DVector<f64>),
    /// Squares of what the likeliest curve leaves, were it right.
    left: f64,
    /// Samples of that which say as much as one independent one.
    correlation: f64,
}

impl Screen<'_> {
    /// The likeliest curve of one learned law.
    pub fn learned(&self, effect: &'static Effect, place: Place) -> Vec<Start> {
        self.told_apart(self.curves(effect, place))
    }

    /// A learned law in first order, at each of its resolutions and in each recording that has its own.
    pub(super) fn curves(&self, effect: &'static Effect, place: Place) -> Vec<Curve> {
        let neutral = effect.resolutions().flat_map(|own| self.starts(own, place));
        neutral.filter_map(|neutral| self.curve(neutral)).collect()
    }

    fn curve(&self, neutral: Term) -> Option<Curve> {
        let effect = neutral.effect;
        let ordinates = ordinates(effect);
        let step = FINE * size(&self.problem.scales, effect);
        let last = self.point.terms.len();
        let column = |&index: &usize| {
            let mut moved = neutral.clone();
            moved.values[index] += step;
            let moved = self.point.with(moved);
            let run = |e: usize| {
                self.problem
                    .run_again(&moved, e, last, &self.linear.runs[e])
            };
            self.without_own(self.change(run) / step)
        };
        let columns: Vec<DVector<f64>> = ordinates.iter().map(column).collect();
        let root = root(effect) * (CURVE * size(&self.problem.scales, effect));
        let slopes = DMatrix::from_columns(&columns) * &root;
        let products = (slopes.tr_mul(&slopes), slopes.tr_mul(&self.residual));
        // A fit starts from a residual that is known no better than its own size allows.
        let unit = (self.residual.norm_squared() / self.residual.len() as f64).max(1.0);
        let values = root * likeliest(&products, unit)?.0;
        let mut term = neutral;
        let (low, high) = (effect.parameters[ordinates[0]].bounds)(&self.problem.scales);
        for (&index, value) in ordinates.iter().zip(values.iter()) {
            term.values[index] = value.clamp(low, high);
        }
        let left = &self.residual + slopes * likeliest(&products, 1.0)?.0;
        Some(Curve {
            term,
            products,
            left: left.norm_squared(),
            correlation: correlation(&left),
        })
    }

    /// The curves with their evidence in first order, in units of the cost: twice its logarithm, times the noise. What is
    /// noise is what the law leaves that leaves least, `n` rows of the variance `v`, of which `c` say as much as one:
    ///
    /// ```text
    /// ln p = (|r|^2 - |r + S w|^2) / 2 v c - |w|^2 / 2 - ln det(I + S'S / v c) / 2
    /// ```
    pub(super) fn told_apart(&self, curves: Vec<Curve>) -> Vec<Start> {
        let least = curves.iter().min_by(|a, b| a.left.total_cmp(&b.left));
        let rows = self.residual.len() as f64;
        let noise = least.map_or(1.0, |own| (own.left / rows).max(1.0) * own.correlation);
        let start = |own: Curve| {
            let score = own.gain(noise).filter(|score| score.is_finite())?;
            Some(Start {
                term: own.term,
                score,
                factor: Factor::None,
            })
        };
        let mut all: Vec<Start> = curves.into_iter().filter_map(start).collect();
        all.sort_by(|a, b| b.score.total_cmp(&a.score));
        // Of the resolutions of a law, and of the recordings in which it may have happened, the likeliest.
        let mut best: Vec<Start> = Vec::new();
        for own in all {
            if !(best.iter()).any(|known| known.term.identity() == own.term.identity()) {
                best.push(own);
            }
        }
        best
    }
}

impl Curve {
    /// Its evidence against none, times twice the noise.
    fn gain(&self, noise: f64) -> Option<f64> {
        let (white, determinant) = likeliest(&self.products, noise)?;
        let fall = -2.0 * white.dot(&self.products.1) - white.dot(&(&self.products.0 * &white));
        Some(fall - noise * (white.norm_squared() + determinant))
    }
}

/// Likeliest white unknowns of a curve where the residual has this variance, and `ln det(I + S'S / v)`.
fn likeliest(
    (normal, gradient): &(DMatrix<f64>, DVector<f64>),
    variance: f64,
) -> Option<(DVector<f64>, f64)> {
    let identity = DMatrix::<f64>::identity(gradient.len(), gradient.len());
    let factors = Cholesky::new(normal / variance + identity)?;
    let white = -factors.solve(gradient) / variance;
    Some((white, factors.ln_determinant()))
}

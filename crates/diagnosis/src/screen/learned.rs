//! Screening of learned laws: the likeliest curve in first order, and its evidence.

use super::{Screen, Start};
use crate::autocorrelation::correlation;
use crate::curves::{ordinates, root, size};
use nalgebra::{Cholesky, DMatrix, DVector};
use quell_model::Term;
use quell_model::effects::{Effect, Place};

/// Step of the derivative by an ordinate of a learned law, in typical sizes.
const FINE: f64 = 1e-2;
/// Greatest standard deviation of a learned law's curve in first order, in typical sizes.
const CURVE: f64 = 3.0;

impl Screen<'_> {
    /// A learned law with its likeliest curve in first order, at the resolution of the highest evidence; of a law of each
    /// recording, that of the highest.
    pub(super) fn curves(&self, effect: &'static Effect, place: Place) -> Vec<Start> {
        let neutral = effect.resolutions().flat_map(|own| self.starts(own, place));
        let curves = neutral.filter_map(|neutral| self.curve(neutral));
        let best = curves.max_by(|a, b| a.score.total_cmp(&b.score));
        best.into_iter().collect()
    }

    /// A curve in first order. Its score is its evidence, in units of the cost: twice the logarithm, times the residual's
    /// own size and correlation.
    fn curve(&self, neutral: Term) -> Option<Start> {
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
        let gradient = slopes.tr_mul(&self.residual);
        // The residual is known no better than its own size allows.
        let unit = (self.residual.norm_squared() / self.residual.len() as f64).max(1.0);
        let normal = slopes.tr_mul(&slopes);
        let (white, _) = likeliest(&normal, &gradient, unit)?;
        let values = root * &white;
        let mut start = neutral;
        let (low, high) = (effect.parameters[ordinates[0]].bounds)(&self.problem.scales);
        for (&index, value) in ordinates.iter().zip(values.iter()) {
            start.values[index] = value.clamp(low, high);
        }
        let score =
            2.0 * unit * self.correlation() * self.evidence_of(&slopes, (&normal, &gradient))?;
        score.is_finite().then_some(Start {
            term: start,
            score,
            factor: 1.0,
        })
    }

    /// Samples of the residual that say as much as one independent one.
    fn correlation(&self) -> f64 {
        *self.correlation.get_or_init(|| correlation(&self.residual))
    }

    /// Logarithm of the evidence of a curve in first order, against none. `slopes` are the changes of the rows by its
    /// white unknowns; their products with themselves and with the residual follow.
    ///
    /// The variance `v` of what is left, at least that of the noise, is not known before: it is the one that is left.
    /// Samples that are correlated say less, as many times as `c`:
    ///
    /// ```text
    /// ln p = -|r + S w|^2 / 2 v c - |w|^2 / 2 - ln det(I + S'S / v c) / 2 - n ln v / 2 c
    /// ```
    fn evidence_of(
        &self,
        slopes: &DMatrix<f64>,
        (normal, gradient): (&DMatrix<f64>, &DVector<f64>),
    ) -> Option<f64> {
        let correlation = self.correlation();
        let rows = self.residual.len() as f64;
        let variance = |left: f64| (left / rows).max(1.0);
        let fits = |left: f64, v: f64| -0.5 * (left / v + rows * v.ln()) / correlation;
        let none = self.residual.norm_squared();
        let solved = |v: f64| {
            let (white, determinant) = likeliest(normal, gradient, v * correlation)?;
            let left = (&self.residual + slopes * &white).norm_squared();
            Some((left, white.norm_squared(), determinant))
        };
        let first = variance(solved(variance(none))?.0);
        let (left, size, determinant) = solved(first)?;
        let own = fits(left, variance(left)) - 0.5 * (size + determinant);
        Some(own - fits(none, variance(none)))
    }
}

/// Likeliest white unknowns of a curve where the residual has this variance, and `ln det(I + S'S / v)`.
fn likeliest(
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    variance: f64,
) -> Option<(DVector<f64>, f64)> {
    let identity = DMatrix::<f64>::identity(gradient.len(), gradient.len());
    let factors = Cholesky::new(normal / variance + identity)?;
    let white = -factors.solve(gradient) / variance;
    Some((white, factors.ln_determinant()))
}

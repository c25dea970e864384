//! What other data say about the shared unknowns, as a quadratic form.

use super::fit::scales;
use nalgebra::{Cholesky, DMatrix, DVector};

/// `(x - x_0)^T N (x - x_0) + 2 g^T (x - x_0)` over the shared unknowns `x`, as the fit sees them.
#[derive(Clone)]
pub struct Prior {
    /// `x_0`, the point about which other data were linearised.
    pub centre: DVector<f64>,
    /// `N`.
    normal: DMatrix<f64>,
    /// `g`.
    gradient: DVector<f64>,
}

impl Prior {
    /// From normal equations whose first unknowns are the shared ones, at their values `centre`; the
    /// others are at their best for every `x`: the Schur complement.
    pub fn new(centre: DVector<f64>, normal: &DMatrix<f64>, gradient: &DVector<f64>) -> Self {
        let (shared, own) = (centre.len(), normal.nrows() - centre.len());
        let mut reduced = Self {
            centre,
            normal: normal.view((0, 0), (shared, shared)).into_owned(),
            gradient: gradient.rows(0, shared).into_owned(),
        };
        let block = normal.view((shared, shared), (own, own)).into_owned();
        let scale = scales(&block);
        let scaled = DMatrix::from_fn(own, own, |i, j| {
            // A direction that the data do not see is not eliminated; the rounding keeps it positive.
            block[(i, j)] / (scale[i] * scale[j]) + if i == j { 1e-13 } else { 0.0 }
        });
        let Some(root) = Cholesky::new(scaled) else {
            return reduced;
        };
        let mut mixed = normal.view((shared, 0), (own, shared)).into_owned();
        mixed
            .row_iter_mut()
            .zip(&scale)
            .for_each(|(mut row, s)| row /= *s);
        let right = gradient.rows(shared, own).component_div(&scale);
        reduced.normal -= mixed.tr_mul(&root.solve(&mixed));
        reduced.gradient -= mixed.tr_mul(&root.solve(&right));
        reduced
    }

    /// The form at `x`.
    pub fn cost(&self, x: &DVector<f64>) -> f64 {
        let step = x - &self.centre;
        step.dot(&(&self.normal * &step)) + 2.0 * self.gradient.dot(&step)
    }

    /// Adds `N` and half the form's gradient at `x` to normal equations over the same unknowns and
    /// others after them.
    pub fn add(&self, x: &DVector<f64>, normal: &mut DMatrix<f64>, gradient: &mut DVector<f64>) {
        let shared = x.len();
        let mut block = normal.view_mut((0, 0), (shared, shared));
        block += &self.normal;
        let mut rows = gradient.rows_mut(0, shared);
        rows += &self.normal * (x - &self.centre) + &self.gradient;
    }
}

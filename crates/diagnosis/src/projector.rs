//! Projection of linear nuisances out of whitened residuals.
//!
//! Source: Golub and Pereyra, Inverse Problems 19 (2003) on separable least squares.

use super::problem::Problem;
use super::rounding_at_rest::RoundingCovariance;
use nalgebra::{DMatrix, DVector};

/// Projects the linear nuisances of every experiment out of residuals.
pub struct Projector {
    /// Covariance by rounding at rest, for each experiment.
    rounding: Vec<RoundingCovariance>,
    /// Orthonormal basis of the columns, for each experiment.
    bases: Vec<DMatrix<f64>>,
}

impl Projector {
    /// The projector for the rows of a problem.
    pub fn new(problem: &Problem) -> Self {
        let all = || 0..problem.experiments.len();
        let own = |e: usize| RoundingCovariance::new(problem, e, &problem.rows[e]);
        let rounding: Vec<RoundingCovariance> = all().map(own).collect();
        let basis = |e: usize| {
            let mut columns = problem.linear(e);
            for mut column in columns.column_iter_mut() {
                rounding[e].whiten(column.as_mut_slice());
            }
            orthonormal(columns)
        };
        Self {
            bases: all().map(basis).collect(),
            rounding,
        }
    }

    /// The part of the rows that no linear nuisance explains.
    pub fn remove(&self, experiment: usize, rows: &DVector<f64>) -> DVector<f64> {
        let basis = &self.bases[experiment];
        let mut rows = rows.clone();
        self.rounding[experiment].whiten(rows.as_mut_slice());
        if basis.ncols() > 0 {
            let shares = basis.tr_mul(&rows);
            rows.gemv(-1.0, basis, &shares, 1.0);
        }
        rows
    }
}

/// An orthonormal basis of the columns, without linearly dependent ones.
pub fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    let mut basis: Vec<DVector<f64>> = Vec::with_capacity(columns.ncols());
    for column in columns.column_iter() {
        let (mut rest, size) = (column.into_owned(), column.norm());
        // Twice is enough (Kahan, Parlett).
        for _ in 0..2 {
            for q in &basis {
                let share = q.dot(&rest);
                rest.axpy(-share, q, 1.0);
            }
        }
        let left = rest.norm();
        if left > 1e-9 * size && left > 0.0 {
            basis.push(rest / left);
        }
    }
    match basis.is_empty() {
        true => DMatrix::zeros(columns.nrows(), 0),
        false => DMatrix::from_columns(&basis),
    }
}

//! The Cramer-Rao bound of a curve by finite differences, for tests.

use nalgebra::{DMatrix, DVector};

/// `(J^T J)^-1` of a curve at a point, its unknowns of order one.
pub fn covariance<const N: usize>(
    point: [f64; N],
    value: impl Fn([f64; N]) -> DVector<f64>,
) -> DMatrix<f64> {
    let column = |k: usize| {
        let (mut up, mut down) = (point, point);
        up[k] += 1e-6;
        down[k] -= 1e-6;
        (value(up) - value(down)) / 2e-6
    };
    let columns: Vec<DVector<f64>> = (0..N).map(column).collect();
    let jacobian = DMatrix::from_columns(&columns);
    (jacobian.transpose() * jacobian)
        .try_inverse()
        .expect("determined")
}

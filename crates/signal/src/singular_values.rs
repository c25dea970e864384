//! Singular value decomposition of data, which always ends.

use nalgebra::{DMatrix, Dyn, SVD};

/// The decomposition `A = U D V'` of an `m x n` matrix with both sets of vectors, or `None` where it has none: for an
/// empty matrix, for values that are not finite, and for values whose iteration does not converge.
///
/// Nalgebra's own iteration has no limit, and does not end for a matrix of three or more columns with a NaN. Here it
/// has that of LAPACK's `dbdsqr`, `6 k^2` steps with `k = min(m, n)`.
///
/// # Example
/// ```
/// use nalgebra::{DMatrix, DVector};
/// use quell_signal::singular_values;
///
/// let line = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0]);
/// let readings = DVector::from_vec(vec![1.0, 3.0, 5.0]);
/// let fitted = singular_values(line).unwrap().solve(&readings, 1e-10).unwrap();
/// assert!((fitted - DVector::from_vec(vec![1.0, 2.0])).norm() < 1e-12);
/// assert!(singular_values(DMatrix::from_element(3, 3, f64::NAN)).is_none());
/// ```
#[must_use]
pub fn singular_values(matrix: DMatrix<f64>) -> Option<SVD<f64, Dyn, Dyn>> {
    if matrix.is_empty() || matrix.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let smallest = matrix.nrows().min(matrix.ncols());
    matrix.try_svd(true, true, 5.0 * f64::EPSILON, 6 * smallest * smallest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Columns that depend on each other, and values of any size, have a decomposition that gives them back.
        #[test]
        fn dependent_columns_of_any_size_are_given_back(
            values in prop::collection::vec(-1.0..1.0f64, 24),
            exponent in -300..300i32,
            copied in 0..3usize,
        ) {
            let mut matrix = DMatrix::from_column_slice(6, 4, &values) * 10f64.powi(exponent);
            let twin = matrix.column(copied) * 2.0;
            matrix.set_column(3, &twin);
            let back = singular_values(matrix.clone()).unwrap().recompose().unwrap();
            prop_assert!((back - &matrix).amax() <= 1e-13 * matrix.amax());
        }

        /// One value that is not finite, anywhere, is refused.
        #[test]
        fn what_is_not_finite_is_refused(
            columns in 1..6usize,
            at in 0..48usize,
            bad in prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY]),
        ) {
            let mut matrix = DMatrix::from_fn(8, columns, |i, j| ((i * j) as f64).sin() + 1.0);
            matrix[(at % 8, at / 8 % columns)] = bad;
            prop_assert!(singular_values(matrix).is_none());
        }
    }
}

//! Singular value decomposition of data: it always ends, and columns that depend on each other do not disturb it.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Rounding of a singular value, of the greatest one: of `2 n` rotations, each exact to a few units in the last place.
const ROUNDING: f64 = 1e-14;

/// The decomposition `A = L diag(s) R'` of an `m x n` matrix into its `r` singular values that are not 0.
///
/// With `A = Q T` by Householder reflections, it is the eigenvalues of the symmetric matrix `[0 T; T' 0]`: each `s > 0` is one of
/// them, with the eigenvector `[l; r] / sqrt(2)`. Nalgebra's own `SVD` is not used: for a matrix of columns that depend on each
/// other it returns factors whose product is another matrix, in one of some thousand such matrices by up to a third of it, and for one
/// with a NaN it does not end. Source: Golub and Van Loan, Matrix Computations, 4th ed., section 8.6.
///
/// # Example
/// ```
/// use nalgebra::{DMatrix, DVector};
/// use quell_signal::SingularValues;
///
/// let line = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0]);
/// let readings = DVector::from_vec(vec![1.0, 3.0, 5.0]);
/// let fitted = SingularValues::of(&line).unwrap().solve(&readings, 1e-10);
/// assert!((fitted - DVector::from_vec(vec![1.0, 2.0])).norm() < 1e-12);
/// assert!(SingularValues::of(&DMatrix::from_element(3, 3, f64::NAN)).is_none());
/// ```
#[derive(Clone, Debug)]
pub struct SingularValues {
    /// `L`, `m x r`: orthonormal columns.
    pub left: DMatrix<f64>,
    /// `s`, `r` values above 0, the greatest first.
    pub values: DVector<f64>,
    /// `R`, `n x r`: orthonormal columns.
    pub right: DMatrix<f64>,
}

impl SingularValues {
    /// The decomposition of a matrix, or `None` where it has none: for an empty matrix, for values that are not finite, and for values
    /// whose iteration does not converge within LAPACK's limit for symmetric matrices (`dsteqr`).
    #[must_use]
    pub fn of(matrix: &DMatrix<f64>) -> Option<Self> {
        if matrix.is_empty() || matrix.iter().any(|value| !value.is_finite()) {
            return None;
        }
        if matrix.nrows() < matrix.ncols() {
            let Self {
                left,
                values,
                right,
            } = Self::of(&matrix.transpose())?;
            return Some(Self {
                left: right,
                values,
                right: left,
            });
        }
        // Squares of the values neither overflow nor vanish.
        let (scale, n) = (matrix.amax().max(f64::MIN_POSITIVE), matrix.ncols());
        let (q, t) = (matrix / scale).qr().unpack();
        let mut both = DMatrix::zeros(2 * n, 2 * n);
        both.view_mut((0, n), (n, n)).copy_from(&t);
        both.view_mut((n, 0), (n, n)).copy_from(&t.transpose());
        let found = SymmetricEigen::try_new(both, f64::EPSILON, 60 * n)?;
        let sizes = found.eigenvalues;
        let least = ROUNDING * sizes.amax();
        let mut order: Vec<usize> = (0..2 * n).filter(|&k| sizes[k] > least).collect();
        order.sort_by(|&a, &b| sizes[b].total_cmp(&sizes[a]));
        let vectors = found.eigenvectors.select_columns(&order) * 2f64.sqrt();
        let values = order.iter().map(|&k| scale * sizes[k]);
        Some(Self {
            left: q * vectors.rows(0, n),
            values: DVector::from_iterator(order.len(), values),
            right: vectors.rows(n, n).into_owned(),
        })
    }

    /// The pseudo-inverse, `n x m`. A singular value of at most `cutoff` (0 to 1) times the greatest one counts as 0.
    #[must_use]
    pub fn pseudo_inverse(&self, cutoff: f64) -> DMatrix<f64> {
        self.inverted(cutoff) * self.left.transpose()
    }

    /// The shortest solution of `A x = b` by least squares, as with [`Self::pseudo_inverse`].
    ///
    /// # Panics
    /// If `b` has not as many values as the matrix has rows.
    #[must_use]
    pub fn solve(&self, b: &DVector<f64>, cutoff: f64) -> DVector<f64> {
        self.inverted(cutoff) * self.left.tr_mul(b)
    }

    /// `R diag(1 / s)`, `n x r`: its rows times their transposes are `(A' A)^-1`, the covariance of a solution for unit noise.
    #[must_use]
    pub fn inverted(&self, cutoff: f64) -> DMatrix<f64> {
        let least = cutoff * self.values.iter().copied().fold(0.0, f64::max);
        let mut inverted = self.right.clone();
        for (mut column, &value) in inverted.column_iter_mut().zip(&self.values) {
            column *= if value > least { 1.0 / value } else { 0.0 };
        }
        inverted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn off_unit(columns: &DMatrix<f64>) -> f64 {
        (columns.tr_mul(columns) - DMatrix::identity(columns.ncols(), columns.ncols())).amax()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        /// Columns that depend on each other, and values of any size, have a decomposition that gives them back.
        #[test]
        fn dependent_columns_of_any_size_are_given_back(
            values in prop::collection::vec(prop_oneof![3 => -1.0..1.0f64, 1 => Just(0.0)], 24),
            exponent in -300..300i32,
            copied in 0..3usize,
            wide in any::<bool>(),
        ) {
            let mut matrix = DMatrix::from_column_slice(6, 4, &values) * 10f64.powi(exponent);
            let twin = matrix.column(copied) * 2.0;
            matrix.set_column(3, &twin);
            if wide {
                matrix = matrix.transpose();
            }
            let found = SingularValues::of(&matrix).unwrap();
            let back = &found.left * DMatrix::from_diagonal(&found.values) * found.right.transpose();
            prop_assert!((back - &matrix).amax() <= 1e-13 * matrix.amax());
            prop_assert!(found.values.len() < 4);
            // Vectors of a value near 0 are as exact as that value.
            let least = found.values.iter().copied().fold(f64::INFINITY, f64::min);
            let exact = ROUNDING * found.values.iter().copied().fold(0.0, f64::max) / least;
            prop_assert!(off_unit(&found.left).max(off_unit(&found.right)) <= 10.0 * exact.max(ROUNDING));
        }
    }

    proptest! {
        /// One value that is not finite, anywhere, is refused.
        #[test]
        fn what_is_not_finite_is_refused(
            columns in 1..6usize,
            at in 0..48usize,
            bad in prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY]),
        ) {
            let mut matrix = DMatrix::from_fn(8, columns, |i, j| ((i * j) as f64).sin() + 1.0);
            matrix[(at % 8, at / 8 % columns)] = bad;
            prop_assert!(SingularValues::of(&matrix).is_none());
        }
    }
}

//! The triangular factor of a tall matrix whose rows are not kept.

use nalgebra::{DMatrix, SMatrix};

/// Rows of a block: with a dozen columns it fits in the first-level cache.
const BLOCK: usize = 256;

/// `R` of `A = Q R`, with `N` columns and any number of rows that arrive one by one.
///
/// `R^T R = A^T A` without the squared condition number of the normal equations: Householder reflections reduce
/// each block of rows, together with the present triangle, to one triangle.
///
/// Source: Demmel, Grigori, Hoemmen, Langou, Communication-optimal parallel and sequential QR and LU
/// factorizations, SIAM J. Scientific Computing 34 (2012), sequential TSQR.
pub struct Triangle<const N: usize> {
    /// The triangle, and below it the rows that are not reduced yet.
    rows: DMatrix<f64>,
    filled: usize,
}

impl<const N: usize> Triangle<N> {
    /// A triangle without rows.
    pub fn new() -> Self {
        Self {
            rows: DMatrix::zeros(N + BLOCK, N),
            filled: 0,
        }
    }

    /// Takes a row.
    pub fn push(&mut self, row: &[f64; N]) {
        for (column, value) in row.iter().enumerate() {
            self.rows[(N + self.filled, column)] = *value;
        }
        self.filled += 1;
        if self.filled == BLOCK {
            self.fold();
        }
    }

    /// The triangle of all rows since the last call; later rows begin a new matrix.
    pub fn take(&mut self) -> SMatrix<f64, N, N> {
        self.fold();
        let triangle = self.rows.fixed_view::<N, N>(0, 0).into_owned();
        self.rows.fill(0.0);
        triangle
    }

    /// Reduces the rows to the triangle. A full block is not copied.
    fn fold(&mut self) {
        let there = match self.filled {
            BLOCK => std::mem::replace(&mut self.rows, DMatrix::zeros(N + BLOCK, N)),
            filled => self.rows.rows(0, N + filled).into_owned(),
        };
        self.rows.rows_mut(0, N).copy_from(&there.qr().r());
        self.filled = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::{array::uniform3, collection::vec, prelude::*};

    proptest! {
        #[test]
        fn it_has_the_products_of_all_rows(rows in vec(uniform3(-1e3..1e3f64), 0..700)) {
            let mut triangle = Triangle::<3>::new();
            rows.iter().for_each(|row| triangle.push(row));
            let found = triangle.take();
            let whole = DMatrix::from_fn(rows.len(), 3, |i, j| rows[i][j]);
            let products = whole.tr_mul(&whole);
            let size = products.amax().max(1.0);
            prop_assert!((found.tr_mul(&found) - &products).amax() < 1e-12 * size);
            prop_assert_eq!(found, found.upper_triangle());
            prop_assert_eq!(triangle.take(), SMatrix::<f64, 3, 3>::zeros());
        }
    }
}

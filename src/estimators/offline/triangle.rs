//! The triangle of a tall matrix, whose rows are not kept.

use nalgebra::SMatrix;

/// Rows that are taken at once: with a dozen columns they stay in the nearest cache.
const BLOCK: usize = 256;

/// Sums that are taken side by side, as processors do.
const LANES: usize = 8;

/// `R` of `A = Q R`, with `N` columns and any number of rows that come one by one.
///
/// `R^T R = A^T A` without the squared condition of the normal equations: Householder's reflections make
/// one triangle of each block of rows and the triangle of those before. Own code, as these columns are
/// few and many blocks go through it: the library's took three times as long.
///
/// Source: Demmel, Grigori, Hoemmen, Langou, Communication-optimal parallel and sequential QR and LU
/// factorizations, SIAM J. Scientific Computing 34 (2012), sequential TSQR; Golub and Van Loan, Matrix
/// Computations, 4th ed., section 5.1.
pub struct Triangle<const N: usize> {
    triangle: SMatrix<f64, N, N>,
    /// Columns of the rows that are not in it yet; zero behind the last.
    columns: Box<[[f64; BLOCK]; N]>,
    filled: usize,
}

impl<const N: usize> Triangle<N> {
    /// Of no rows.
    pub fn new() -> Self {
        Self {
            triangle: SMatrix::zeros(),
            columns: Box::new([[0.0; BLOCK]; N]),
            filled: 0,
        }
    }

    /// Takes a row.
    pub fn push(&mut self, row: &[f64; N]) {
        for (column, value) in self.columns.iter_mut().zip(row) {
            column[self.filled] = *value;
        }
        self.filled += 1;
        if self.filled == BLOCK {
            self.fold();
        }
    }

    /// The triangle of all rows since the last call; those that come are another matrix's.
    pub fn take(&mut self) -> SMatrix<f64, N, N> {
        self.fold();
        std::mem::replace(&mut self.triangle, SMatrix::zeros())
    }

    /// Turns the rows into the triangle. A reflection for a column sees one row of the triangle: below its
    /// diagonal there is nothing.
    fn fold(&mut self) {
        let length = self.filled.next_multiple_of(LANES);
        for k in 0..N {
            let (before, after) = self.columns.split_at_mut(k + 1);
            let own = &before[k][..length];
            let head = self.triangle[(k, k)];
            let norm = (head * head + dot(own, own)).sqrt();
            if norm == 0.0 {
                continue;
            }
            let pivot = head + norm.copysign(head);
            for (c, column) in after.iter_mut().enumerate() {
                let column = &mut column[..length];
                let top = &mut self.triangle[(k, k + 1 + c)];
                // The reflection along (pivot, own), whose squared length is 2 norm |pivot|.
                let share = (pivot * *top + dot(own, column)) / (norm * pivot.abs());
                *top -= share * pivot;
                for (value, along) in column.iter_mut().zip(own) {
                    *value -= share * along;
                }
            }
            self.triangle[(k, k)] = -norm.copysign(head);
        }
        self.columns
            .iter_mut()
            .for_each(|column| column[..length].fill(0.0));
        self.filled = 0;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    for (a, b) in a.chunks_exact(LANES).zip(b.chunks_exact(LANES)) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;
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

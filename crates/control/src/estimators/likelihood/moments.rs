//! Sums of products of the columns of every row.

use crate::estimators::modal_response::WIDTH;

/// Sums of products of the columns of every row; a symmetric matrix, stored in blocks of two from the diagonal
/// on.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    sums: [[f64; WIDTH]; WIDTH],
}

impl Moments {
    /// The sums of no rows.
    pub const ZERO: Self = Self {
        sums: [[0.0; WIDTH]; WIDTH],
    };

    /// Adds a row.
    pub fn add(&mut self, row: &[f64; WIDTH]) {
        self.add_from::<0>(row);
        self.add_from::<2>(row);
        self.add_from::<4>(row);
        self.add_from::<6>(row);
        self.add_from::<8>(row);
        self.add_from::<10>(row);
        self.add_from::<12>(row);
    }

    /// Two lines of the matrix, with a length that is constant for the compiler.
    #[inline(always)]
    fn add_from<const FIRST: usize>(&mut self, row: &[f64; WIDTH]) {
        for i in FIRST..FIRST + 2 {
            for j in FIRST..WIDTH {
                self.sums[i][j] += row[i] * row[j];
            }
        }
    }

    /// Sum of the products of two columns.
    #[inline]
    pub fn of(&self, i: usize, j: usize) -> f64 {
        self.sums[i.min(j)][i.max(j)]
    }

    /// Sums of the products of column `i` with those from the diagonal on; the entries before are not valid.
    #[inline]
    pub fn line(&self, i: usize) -> &[f64; WIDTH] {
        &self.sums[i]
    }
}

//! Accumulated linear least squares, eq. (24), with scaled columns and a gate.

use nalgebra::{SMatrix, SVector};

/// Columns at most: two of the mode, two of the input, one of a constant offset.
pub const COLUMNS: usize = 5;

/// Largest condition number of the scaled normal matrix: it squares that of the columns, and
/// 1e10 leaves six of sixteen digits.
const LARGEST_CONDITION: f64 = 1e10;

/// `theta = [int p^T p]^-1 int p^T q`, accumulated sample by sample.
///
/// Source: eq. (24); singular at `t -> 0` as printed, so the columns are scaled to unit length and
/// nothing is returned while their normal matrix is worse conditioned than 1e10 (erratum).
#[derive(Clone, Copy, Debug)]
pub struct LeastSquares {
    normal: SMatrix<f64, COLUMNS, COLUMNS>,
    rhs: SVector<f64, COLUMNS>,
}

impl Default for LeastSquares {
    fn default() -> Self {
        Self {
            normal: SMatrix::zeros(),
            rhs: SVector::zeros(),
        }
    }
}

impl LeastSquares {
    /// Adds the row `p theta = q` with a weight (the time it stands for).
    pub fn push(&mut self, row: [f64; COLUMNS], value: f64, weight: f64) {
        let row = SVector::from(row);
        self.normal += row * row.transpose() * weight;
        self.rhs += row * (value * weight);
    }

    /// The unknowns of the columns in use, 0 for the others; `None` while they are not determined.
    pub fn solve(&self, used: [bool; COLUMNS]) -> Option<[f64; COLUMNS]> {
        let mut scale = [0.0; COLUMNS];
        for i in (0..COLUMNS).filter(|&i| used[i]) {
            let length = self.normal[(i, i)].sqrt();
            if !(length.is_finite() && length > 0.0) {
                return None;
            }
            scale[i] = length.recip();
        }
        let scaled = SMatrix::<f64, COLUMNS, COLUMNS>::from_fn(|i, j| match (used[i], used[j]) {
            (true, true) => self.normal[(i, j)] * scale[i] * scale[j],
            _ if i == j => 1.0,
            _ => 0.0,
        });
        let eigenvalues = scaled.symmetric_eigenvalues();
        if eigenvalues.min() * LARGEST_CONDITION <= eigenvalues.max() {
            return None;
        }
        let rhs = SVector::<f64, COLUMNS>::from_fn(|i, _| self.rhs[i] * scale[i]);
        let solution = scaled.cholesky()?.solve(&rhs);
        Some(core::array::from_fn(|i| solution[i] * scale[i]))
    }
}
